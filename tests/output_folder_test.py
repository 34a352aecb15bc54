# SPDX-FileCopyrightText: The kilter authors
# SPDX-License-Identifier: BSD-3-Clause
"""Where `kilter check` writes: what it refuses to write to, and that nobody's files and no earlier result are harmed."""

from __future__ import annotations

import json
import os
import re
import resource
import shutil
import signal
import subprocess
import time
import unittest
from pathlib import Path

from check_test import FILES, CheckCase
from kilter_runner import SOURCE_DIR, kilter_binary, main, run_kilter
from tiny_mission import bytes_below


def anything_in(folder: Path, pattern: str) -> bool:
    """Whether anything matches; nothing does where a folder is removed while it is looked through, which pathlib calls an error."""
    try:
        return any(folder.glob(pattern))
    except FileNotFoundError:
        return False


class OutputFolder(CheckCase):
    def test_files_of_others_stay_and_links_are_not_followed(self):
        self.out.mkdir()
        (self.out / "notes.txt").write_text("mine")
        elsewhere = self.tiny.folder / "elsewhere.csv"
        elsewhere.write_text("precious")
        (self.out / "pairs.csv").symlink_to(elsewhere)
        self.assertEqual(self.check().status, 1)
        self.assertEqual((self.out / "notes.txt").read_text(), "mine")
        self.assertEqual(elsewhere.read_text(), "precious")
        self.assertFalse((self.out / "pairs.csv").is_symlink())

    def test_files_of_others_under_names_of_ours_are_refused_before_any_work(self):
        self.assertEqual(self.check("--maps").status, 1)
        ours = bytes_below(self.out)
        for name, removed, words in (("result.json", (), "no result of kilter's"),
                                     ("pairs.csv", ("result.json", "result.kilter", "report.html"), "no result of kilter's beside it"),
                                     ("maps/a.ply", (), "no map of kilter's"), ("maps/global.ot", ("maps/global.ply",), "no map")):
            with self.subTest(name):
                for gone in removed:
                    (self.out / gone).unlink()
                file = self.out / name
                file.write_text('{"of": "somebody else"}\n')
                if name == "pairs.csv":
                    for other in sorted(ours.keys() - {name}):
                        (self.out / other).unlink(missing_ok=True)
                before = bytes_below(self.out)
                run = self.check("--maps", "--verbose")
                self.assertEqual((run.status, run.stdout), (2, ""), run.stderr)
                self.assertIn(f"usage: {file}: there is a file already, and ", run.stderr)
                self.assertIn(words, run.stderr)
                self.assertNotIn("submaps", run.stderr)
                self.assertTrue(bytes_below(self.out) == before)
                for other, content in ours.items():
                    (self.out / other).write_bytes(content)
        (self.out / "result.json").unlink()
        (self.out / "map.png").write_bytes(b"")
        self.assertEqual(self.check("--maps").status, 1, "the rest of a result, and an empty file, are not kept")
        self.assertEqual(set(bytes_below(self.out)), set(ours))

    def test_a_result_is_known_for_kilters_by_any_one_of_its_marks(self):
        self.assertEqual(self.check("--maps").status, 1)
        ours = bytes_below(self.out)
        result = json.loads(ours["result.json"])
        # What a run leaves that is killed between its renames: the first ones. Results that others wrote anew, too.
        states = {name: {name: ours[name], "map.png": ours["map.png"]} for name in ("result.kilter", "result.json", "report.html")}
        states["maps, and nothing else"] = {name: content for name, content in ours.items() if name.startswith("maps/")}
        states["sorted"] = {"map.png": ours["map.png"], "result.json": json.dumps(result, sort_keys=True, indent=1).encode()}
        states["packed"] = {"map.png": ours["map.png"], "result.json": json.dumps(result, separators=(",", ":")).encode()}
        states["spaced"] = {"map.png": ours["map.png"], "result.json": ours["result.json"].replace(b":", b" :\t")}
        for name, state in states.items():
            with self.subTest(name):
                shutil.rmtree(self.out)
                for file, content in state.items():
                    (self.out / file).parent.mkdir(parents=True, exist_ok=True)
                    (self.out / file).write_bytes(content)
                run = self.check("--maps")
                self.assertEqual(run.status, 1, run.stderr)
                self.assertEqual(set(bytes_below(self.out)), set(ours))

    def test_a_result_that_lies_elsewhere_is_known_through_its_link(self):
        self.assertEqual(self.check().status, 1)
        elsewhere = self.tiny.folder / "elsewhere.json"
        (self.out / "result.json").rename(elsewhere)
        (self.out / "result.json").symlink_to(elsewhere)
        for name in ("result.kilter", "report.html"):
            (self.out / name).unlink()
        before = elsewhere.read_bytes()
        self.assertEqual(self.check().status, 1)
        self.assertEqual(elsewhere.read_bytes(), before)
        self.assertFalse((self.out / "result.json").is_symlink())

    def test_what_only_mentions_kilter_is_no_mark_of_its(self):
        for name, content in (("result.json", '{"input_schema":"kilter.result/1"}'), ("result.json", '{"schema", "kilter.result/1"'),
                              ("report.html", "<!DOCTYPE html><title>kilter, my notes</title>")):
            with self.subTest(name):
                self.out.mkdir()
                (self.out / name).write_text(content)
                self.assertEqual(self.check().status, 2)
                self.assertEqual((self.out / name).read_text(), content)
                shutil.rmtree(self.out)

    def check_while_renames_fail(self, failure: str, when: str, *options: str) -> subprocess.CompletedProcess[str]:
        """A run of which certain renames end so. Each file has two: into the hidden folder, and out of it to its name."""
        traced = ["strace", "-f", "-o", "/dev/null", "-e", "trace=/rename.*", "-e", f"inject=/rename.*:{failure}:when={when}"]
        if "KILTER_INSTRUMENTED" in os.environ:
            self.skipTest("sanitizers cannot be traced")
        if not shutil.which("strace") or subprocess.run([*traced, "true"], capture_output=True, check=False).returncode:
            self.skipTest("no strace that can be used")
        command = [*traced, str(kilter_binary()), "check", str(self.tiny.mission), "-o", str(self.out), *self.settings,
                   *options]
        return subprocess.run(command, capture_output=True, text=True, check=False)

    def test_a_run_that_is_killed_between_renames_is_known_to_the_next(self):
        for count in (1, 2, len(FILES) - 1):
            with self.subTest(renamed=count):
                shutil.rmtree(self.out, ignore_errors=True)
                self.check_while_renames_fail("signal=KILL", str(len(FILES) + count))
                self.assertFalse((self.out / "result.json").exists())
                self.assertIn(len([path for path in self.out.iterdir() if path.is_file()]), (count - 1, count))
                run = self.check()
                self.assertEqual(run.status, 1, run.stderr)
                self.assertLessEqual(FILES, set(bytes_below(self.out)))

    def test_renames_that_cannot_be_taken_back_are_told_as_they_are(self):
        for replaced in (False, True):
            with self.subTest(replaced=replaced):
                before = bytes_below(self.out)
                run = self.check_while_renames_fail("error=EPERM", f"{len(FILES) + 3}+")
                self.assertEqual((run.returncode, run.stdout), (5, ""), run.stderr)
                words = "what they replaced is in (.*)" if replaced else "they replaced nothing()"
                hint = re.search(f"\n  try: some new files have their names and could not be taken back; {words}\n$", run.stderr)
                self.assertIsNotNone(hint, run.stderr)
                self.assertEqual(len(list(self.out.glob(".kilter-*"))), 1 if replaced else 0)
                if replaced:
                    self.assertEqual(bytes_below(Path(hint[1])), {name: before[name] for name in ("pairs.csv", "result.kilter")})
                self.assertEqual(self.check().status, 1)

    @unittest.skipUnless(os.geteuid() == 0, "only root can become another user")
    def test_a_file_that_cannot_be_read_is_not_called_somebody_elses(self):
        self.out.mkdir()
        self.out.chmod(0o777)
        file = self.out / "result.json"
        file.write_text("{}")
        file.chmod(0)
        run = self.as_nobody("check", self.tiny.mission, "-o", self.out, *self.settings)
        self.assertEqual((run.returncode, run.stdout), (2, ""), run.stderr)
        self.assertIn(f"usage: {file}: there is a file already, and it cannot be read: Permission denied", run.stderr)

    def test_a_file_that_is_put_there_during_the_work_is_not_replaced(self):
        with subprocess.Popen([str(kilter_binary()), "check", str(self.tiny.mission), "-o", str(self.out), *self.settings,
                               "--verbose"], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as run:
            while (line := run.stderr.readline()) and "submaps" not in line:
                pass
            self.out.mkdir()
            (self.out / "pairs.csv").write_text("mine")
            stdout, stderr = run.communicate()
        self.assertEqual((run.returncode, stdout), (2, ""), stderr)
        self.assertEqual(bytes_below(self.out), {"pairs.csv": b"mine"})

    def test_a_link_in_the_place_of_the_maps_folder_is_refused(self):
        self.out.mkdir()
        target = self.tiny.folder / "linked"
        target.mkdir()
        (self.out / "maps").symlink_to(target)
        self.assertEqual(self.check("--maps").status, 5)
        self.assertEqual(list(target.iterdir()), [])
        self.assertFalse((self.out / "result.json").exists())

    def test_a_file_in_the_place_of_the_output_folder_is_refused_before_any_work(self):
        self.out.write_text("mine")
        run = self.check("--verbose")
        self.assertEqual(run.status, 5)
        self.assertRegex(run.stderr, r"^io: .*expected a folder")
        self.assertNotIn("submaps", run.stderr)
        self.assertEqual(self.out.read_text(), "mine")

    def test_a_name_that_the_disk_does_not_take_is_refused_in_its_words(self):
        for command in ("check", "submaps"):
            run = run_kilter(command, self.tiny.mission, "-o", self.tiny.folder / ("x" * 300), "--verbose")
            self.assertEqual((run.status, run.stdout), (5, ""))
            self.assertRegex(run.stderr, r"(?m)^io: .*x: nothing can be written there: File name too long$")

    def test_a_robot_whose_name_the_disk_does_not_take_is_found_out_before_any_work(self):
        for command, name, file in (("check", "x" * 252, r"maps/x+\.ply"), ("submaps", "x" * 300, r"x+(/submaps/000000\.ot)?")):
            run = run_kilter(command, f"{name}={self.tiny.mission / 'a'}", "-o", self.out, "--verbose",
                             *(("--maps",) if command == "check" else ()))
            self.assertEqual((run.status, run.stdout), (5, ""), run.stderr)
            self.assertRegex(run.stderr, rf"(?m)^io: {re.escape(str(self.out))}/{file}: cannot be written: File name too long$")
            self.assertIn("\n  try: name another folder with -o, or call the robot otherwise", run.stderr)
            self.assertNotIn("submaps of", run.stderr)
            self.assertFalse(self.out.exists())

    @unittest.skipUnless(os.path.isdir("/proc/self"), "there is no /proc here")
    def test_a_folder_that_cannot_be_made_is_found_out_before_any_work(self):
        for command in ("check", "submaps", "simulate"):
            source = "office" if command == "simulate" else self.tiny.mission
            run = run_kilter(command, source, "-o", "/proc/kilter/out", "--verbose")
            self.assertEqual((run.status, run.stdout), (5, ""))
            self.assertRegex(run.stderr, r"(?m)^io: /proc/kilter(/out)?: ")
            self.assertNotRegex(run.stderr, "submaps of|pairs|scans: ")

    def test_looking_whether_it_can_be_written_to_leaves_no_trace(self):
        run = run_kilter("check", self.tiny.mission, "-o", self.tiny.folder / "not" / "made", "--memory", "10K")
        self.assertEqual(run.status, 5)
        self.assertRegex(run.stderr, "(?m)^out-of-memory: ")
        self.assertFalse((self.tiny.folder / "not").exists())

    def test_a_folder_in_the_place_of_a_file_is_refused_before_any_work(self):
        for name in sorted({*FILES, "maps/a.ply", "maps/a.ot", "maps/global.ply", "maps/global.ot"}):
            with self.subTest(name):
                (self.out / name).mkdir(parents=True)
                run = self.check("--verbose", "--maps")
                self.assertEqual(run.status, 5)
                self.assertRegex(run.stderr, rf"^io: {re.escape(str(self.out / name))}: ")
                self.assertNotIn("submaps", run.stderr)
                self.assertEqual([path for path in self.out.rglob("*") if path.is_file()], [])
                (self.out / name).rmdir()

    def test_a_folder_that_holds_a_sources_clouds_is_refused(self):
        mission = self.tiny.copy("guarded", robots="ab")
        flat = self.tiny.folder / "flat"
        (flat / "maps").mkdir(parents=True)
        scans = sorted((mission / "a" / "scans").iterdir())
        for file in (*scans, mission / "a" / "poses.tum"):
            (flat / "maps" / file.name).write_bytes(file.read_bytes())
        (self.tiny.folder / "link").symlink_to(mission / "b" / "scans")
        for source, out, options in ((mission, mission / "b" / "scans", ()), (mission, self.tiny.folder / "link", ()),
                                     (mission, mission / "a" / ".." / "b" / "scans", ()), (flat / "maps", flat / "maps", ()),
                                     (flat / "maps", flat, ("--maps",))):
            with self.subTest(out=out):
                before = sorted(self.tiny.folder.rglob("*"))
                run = run_kilter("check", source, "-o", out, *options, *self.settings)
                self.assertEqual((run.status, run.stdout), (2, ""), run.stderr)
                self.assertRegex(run.stderr, "^usage: .*: the clouds of robot (b|maps) lie here\n  try: name another folder")
                self.assertEqual(sorted(self.tiny.folder.rglob("*")), before)
        # What lies beside the clouds' folders, or beside a file that is named itself, is not mixed with them.
        for out in (mission, mission / "a", flat):
            self.assertIn(run_kilter("check", mission, "-o", out, *self.settings).status, (0, 1, 4))
        self.assertIn(run_kilter("check", mission, "-o", mission, *self.settings).status, (0, 1, 4))

    def test_a_cloud_that_is_read_is_not_overwritten(self):
        self.check()
        cloud = self.out / "coloured.ply"
        other = self.tiny.folder / "other.ply"
        other.write_bytes(cloud.read_bytes())
        before = cloud.read_bytes()
        run = run_kilter("check", f"a={cloud}", f"b={other}", "-o", self.out)
        self.assertEqual((run.status, run.stdout), (2, ""), run.stderr)
        self.assertIn("coloured.ply is read and would be overwritten", run.stderr)
        self.assertEqual(cloud.read_bytes(), before)

    def on_a_full_disk(self) -> None:
        """A run with another verdict of which the small files could be written and the large ones cannot."""
        command = [str(kilter_binary()), "check", str(self.tiny.mission), "-o", str(self.out), "--set", "tolerance=0.2",
                   *self.settings]
        limit = lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (400 * 1024, 400 * 1024))  # noqa: E731
        run = subprocess.run(command, capture_output=True, text=True, preexec_fn=limit, check=False)
        self.assertEqual(run.returncode, 5, run.stderr)
        self.assertRegex(run.stderr, r"(?m)^no-space: " + re.escape(str(self.out)) + "/[a-z]+\\.[a-z]+: ")
        self.assertEqual(run.stdout, "")

    def test_a_full_disk_leaves_the_old_result_and_no_fragments(self):
        self.check()
        before = {path.name: path.read_bytes() for path in self.out.iterdir()}
        self.on_a_full_disk()
        self.assertEqual(set(before), FILES)
        after = {path.name: path.read_bytes() for path in self.out.iterdir()}
        self.assertEqual([name for name in before if after.pop(name) != before[name]], [])
        self.assertEqual(after, {})

    def test_a_full_disk_leaves_nothing_where_nothing_was(self):
        self.on_a_full_disk()
        self.assertFalse(self.out.exists())

    def test_a_rename_that_is_refused_half_way_leaves_the_old_result(self):
        self.check()
        before = bytes_below(self.out)
        run = self.check_while_renames_fail("error=EPERM", str(len(FILES) + 5), "--set", "tolerance=0.2")
        self.assertEqual((run.returncode, run.stdout), (5, ""), run.stderr)
        self.assertRegex(run.stderr, rf"(?m)^io: {re.escape(str(self.out))}/[a-z.]+: cannot be written: Operation not permitted")
        self.assertTrue(bytes_below(self.out) == before)
        self.assertEqual(self.check("--set", "tolerance=0.2").status, 1)
        self.assertNotEqual(bytes_below(self.out)["pairs.csv"], before["pairs.csv"])

    def as_nobody(self, *arguments: object) -> subprocess.CompletedProcess[str]:
        """A run of a user who is not root, where the tests run as root."""
        self.tiny.folder.chmod(0o755)
        try:
            return subprocess.run([str(kilter_binary()), *map(str, arguments)], capture_output=True, text=True, check=False,
                                  user=65534, group=65534, extra_groups=[])
        except PermissionError:
            self.skipTest("another user cannot run the program where it lies")

    @unittest.skipUnless(os.geteuid() == 0, "only root can give files away")
    def test_what_only_another_user_may_replace_is_found_out_before_any_work(self):
        self.check()
        self.out.chmod(0o1777)
        page, cloud = self.out / "report.html", self.out / "cloud.ply"
        scan = min((self.tiny.mission / "a" / "scans").iterdir())
        self.assertEqual(run_kilter("register", scan, scan, "-o", cloud).status, 0)
        for path in self.out.iterdir():
            os.chown(path, *((0, 0) if path in (page, cloud) else (65534, 65534)))
        before = bytes_below(self.out)
        for file, *command in ((page, "check", self.tiny.mission, "-o", self.out, "--verbose"),
                               (page, "report", self.out, "-o", page), (cloud, "register", scan, scan, "-o", cloud)):
            run = self.as_nobody(*command)
            self.assertEqual((run.returncode, run.stdout), (5, ""), run.stderr)
            self.assertIn(f"io: {file}: this is another user's", run.stderr)
            self.assertNotIn("submaps", run.stderr)
            self.assertTrue(bytes_below(self.out) == before)
            os.chown(file, 65534, 65534)
            run = self.as_nobody(*command)
            self.assertIn(run.returncode, (0, 1), run.stderr)
            before = bytes_below(self.out)
            os.chown(page, 0, 0)

    def stopped_while_writing(self, folder: Path, *arguments: object) -> tuple[int, str, str]:
        """Status and words of a run that is asked to stop while a file is written that will wait for its name in `folder`."""
        for _ in range(10):
            with subprocess.Popen([str(kilter_binary()), *map(str, arguments)], stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                                  text=True) as run:
                while run.poll() is None and not anything_in(folder, ".kilter-*/*.part"):
                    time.sleep(0.0002)
                run.terminate()
                stdout, stderr = run.communicate()
            if run.returncode < 0 or run.returncode > 5:
                break
            shutil.rmtree(folder)  # it was faster than us
        return (run.returncode, stdout, stderr)

    def test_a_stop_while_results_are_written_leaves_nothing(self):
        run = self.stopped_while_writing(self.out, "check", self.tiny.mission, "-o", self.out, *self.settings, "--quiet")
        self.assertEqual(run, (143, "", "cancelled: stopped on request; nothing was written\n"))
        self.assertFalse(self.out.exists())

    def test_a_stop_while_the_page_is_written_leaves_nothing(self):
        self.check()
        pages = self.tiny.folder / "pages"
        run = self.stopped_while_writing(pages, "report", self.out, "-o", pages / "page.html")
        self.assertEqual(run, (143, "", "cancelled: stopped on request; nothing was written\n"))
        self.assertFalse(pages.exists())

    @unittest.skipIf("KILTER_INSTRUMENTED" in os.environ, "sanitizers cannot be traced")
    def test_a_stop_while_it_looks_whether_it_can_write_leaves_nothing(self):
        # Otherwise it takes microseconds to make and remove a folder.
        slow = ["strace", "-o", "/dev/null", "-e", "trace=rmdir,unlinkat", "-e", "inject=rmdir,unlinkat:delay_enter=1000000:when=1"]
        if not shutil.which("strace") or subprocess.run([*slow, "true"], capture_output=True, check=False).returncode != 0:
            self.skipTest("no strace that can be used")
        for command in ("check", "submaps"):
            with self.subTest(command), subprocess.Popen(
                    [*slow, str(kilter_binary()), command, str(self.tiny.mission), "-o", str(self.out)],
                    stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, start_new_session=True) as run:
                while run.poll() is None and not anything_in(self.out, ".kilter-*"):
                    time.sleep(0.01)
                os.killpg(run.pid, signal.SIGTERM)
                stdout, stderr = run.communicate()
                self.assertEqual((run.returncode, stdout), (143, ""), stderr)
                self.assertRegex(stderr, "(?m)^cancelled: ")
                self.assertFalse(self.out.exists())


if __name__ == "__main__":
    main()
