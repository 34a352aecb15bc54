# SPDX-FileCopyrightText: The kilter authors
# SPDX-License-Identifier: BSD-3-Clause
"""`kilter report` from outside: the same page again, and what it says of files that are no results."""

import struct
import unittest

from kilter_runner import main, run_kilter
from tiny_mission import TinyMission


class Report(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.tiny = TinyMission()
        cls.tiny.__enter__()
        cls.addClassCleanup(cls.tiny.__exit__)
        cls.out = cls.tiny.folder / "out"
        run = run_kilter("check", cls.tiny.mission, "-o", cls.out, "--jobs", "1")
        assert run.status == 1, run.stderr

    def refused(self, source, status, words):
        page = self.tiny.folder / "refused.html"
        run = run_kilter("report", source, "-o", page)
        self.assertEqual(run.status, status, run.stderr)
        self.assertIn(words, run.stderr)
        self.assertFalse(page.exists())

    def test_the_page_is_the_same_whenever_and_wherever_it_is_made(self):
        page = self.tiny.folder / "page.html"
        self.assertEqual(run_kilter("report", self.out, "-o", page).status, 0)
        self.assertEqual(page.read_bytes(), (self.out / "report.html").read_bytes())
        again = self.tiny.folder / "elsewhere"
        self.assertEqual(run_kilter("check", self.tiny.mission, "-o", again, "--jobs", "2").status, 1)
        for name in ("report.html", "result.kilter", "gamma.png", "map.png", "coloured.ply"):
            self.assertEqual((again / name).read_bytes(), (self.out / name).read_bytes(), name)

    def test_the_budget_thins_and_says_so(self):
        few = self.tiny.folder / "few"
        run = run_kilter("check", self.tiny.mission, "-o", few, "--set", "report_max_points=1000")
        self.assertEqual(run.status, 1, run.stderr)
        self.assertLess((few / "result.kilter").stat().st_size, (self.out / "result.kilter").stat().st_size / 2)
        self.assertEqual((few / "pairs.csv").read_bytes(), (self.out / "pairs.csv").read_bytes())

    def test_verbose_says_when_it_begins_and_ends(self):
        run = run_kilter("report", self.out, "-o", self.tiny.folder / "told.html", "--verbose")
        self.assertEqual(run.stderr, "report: 0 of 1 (0 %)\nreport: 1 of 1 (100 %)\n")

    def test_what_is_no_archive_is_named(self):
        self.refused(self.tiny.folder / "absent", 3, "absent")
        self.refused(self.out / "result.json", 3, "result.json: expected an archive of kilter")

    def test_what_holds_no_result_is_told_how_to_make_one(self):
        self.refused(self.tiny.mission, 3, "mission: expected the folder of a result, found no result.kilter in it")
        for source in (self.tiny.mission, self.tiny.folder / "absent"):
            self.refused(source, 3, "`kilter check SOURCE -o OUT` makes one")

    def test_a_damaged_archive_is_refused_with_its_place(self):
        whole = (self.out / "result.kilter").read_bytes()
        damaged = self.tiny.folder / "damaged.kilter"
        damaged.write_bytes(whole[: len(whole) // 2])
        self.refused(damaged, 3, "damaged.kilter")
        damaged.write_bytes(whole[:-1] + bytes([whole[-1] ^ 1]))
        self.refused(damaged, 3, "checksum")
        damaged.write_bytes(whole[:8] + struct.pack("<I", 9) + whole[12:])
        self.refused(damaged, 3, "archive version 9")

    def test_a_page_that_cannot_be_written_is_an_error_of_output(self):
        run = run_kilter("report", self.out, "-o", self.out / "result.json" / "page.html")
        self.assertEqual(run.status, 5, run.stderr)
        self.assertEqual(run_kilter("report", self.out).status, 2)

    def test_a_page_never_takes_the_place_of_what_it_is_made_of(self):
        archive = self.out / "result.kilter"
        before = archive.read_bytes()
        linked = self.tiny.folder / "linked.html"
        linked.symlink_to(archive)
        for source in (self.out, archive):
            for page, words in ((archive, "ends in .html"), (self.out, "ends in .html"), (linked, "would be overwritten")):
                run = run_kilter("report", source, "-o", page)
                self.assertEqual((run.status, run.stdout), (2, ""), run.stderr)
                self.assertIn(words, run.stderr)
        self.assertEqual(archive.read_bytes(), before)
        self.assertTrue(linked.is_symlink())

    def test_a_page_of_somebody_else_stays_and_an_earlier_report_goes(self):
        page = self.tiny.folder / "theirs.html"
        page.write_text("<!DOCTYPE html><title>kilter: my kilter notes</title>")
        run = run_kilter("report", self.out, "-o", page)
        self.assertEqual((run.status, run.stdout), (2, ""), run.stderr)
        self.assertRegex(run.stderr, r"^usage: .*/theirs.html: there is a file already, .*\n  try: name another file")
        self.assertIn("my kilter notes", page.read_text())
        page.write_bytes(b"")
        for _ in range(2):
            self.assertEqual(run_kilter("report", self.out, "-o", page).status, 0)

    def test_a_name_that_the_disk_does_not_take_is_found_out_before_any_work(self):
        damaged = self.tiny.folder / "no.kilter"
        damaged.write_bytes(b"no archive")
        page = self.tiny.folder / "new" / ("x" * 251 + ".html")
        run = run_kilter("report", damaged, "-o", page)
        self.assertEqual((run.status, run.stdout), (5, ""), run.stderr)
        self.assertRegex(run.stderr, r"^io: .*x\.html: cannot be written: File name too long\n  try: name another file")
        self.assertFalse(page.parent.exists())


if __name__ == "__main__":
    main()
