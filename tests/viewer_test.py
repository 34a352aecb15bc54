# SPDX-FileCopyrightText: The kilter authors
# SPDX-License-Identifier: BSD-3-Clause
"""The report in a real browser: viewer/test/report_test.mjs clicks, types and looks; here its lines become tests, and those
of viewer/test/words_test.mjs, which needs no browser.

Needs node, viewer/node_modules and a Chromium; without one of them all is skipped. Screenshots are left in the build
folder, viewer-shots/, to be looked at.
"""

import json
import os
import shutil
import struct
import subprocess
import tempfile
import unittest
from pathlib import Path

from kilter_runner import SOURCE_DIR, kilter_binary, main, run_kilter
from tiny_mission import TinyMission

LONG = "warehouse-north-2026-11-29-afternoon-run-of-robot-"
HOSTILE = ("<img src=x onerror=alert(1)>", "\"'><b>&amp;%2F#")


def missing():
    """What the browser tests lack, in words, or None."""
    if shutil.which("node") is None:
        return "node is not installed"
    if not (SOURCE_DIR / "viewer/node_modules/playwright-core").is_dir():
        return "viewer/node_modules is not there: npm ci in viewer/"
    places = [os.environ.get("KILTER_CHROMIUM"), "/usr/bin/chromium", "/usr/bin/chromium-browser", "/usr/bin/google-chrome"]
    if not any(place and Path(place).exists() for place in places):
        return "no Chromium is installed (Debian: chromium); KILTER_CHROMIUM names one elsewhere"
    return None


def put_into_the_world(pcd, pose, far_m=(200.0, 100.0, 30.0)):
    """Moves the points of a binary PCD file of floats x y z by a pose (x y z qx qy qz qw) and far away."""
    head, separator, body = pcd.read_bytes().partition(b"DATA binary\n")
    x, y, z, w = pose[3:]
    rotation = (
        (1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)),
        (2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)),
        (2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)),
    )
    moved = bytearray()
    for point in struct.iter_unpack("<3f", body):
        turned = (sum(a * b for a, b in zip(row, point)) for row in rotation)
        moved += struct.pack("<3f", *(a + b + c for a, b, c in zip(turned, pose, far_m)))
    pcd.write_bytes(head + separator + bytes(moved))


@unittest.skipIf(missing(), missing())
class Viewer(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(folder.cleanup)
        cls.folder = Path(folder.name)
        cls.shots = kilter_binary().parent / "viewer-shots"
        shutil.rmtree(cls.shots, ignore_errors=True)

    def check(self, name, *sources):
        run = run_kilter("check", *sources, "-o", self.folder / name, "--fail-on", "never", timeout_s=300)
        self.assertEqual(run.status, 0, run.stderr)
        return self.folder / name / "report.html"

    def simulated(self):
        """A report of the simulated office, or of the tiny mission where the simulator was not built."""
        made = run_kilter("simulate", "office", "--scale", "0.6", "-o", self.folder / "office", timeout_s=300)
        if made.status == 0:
            return self.check("out", self.folder / "office/mission")
        with TinyMission() as tiny:
            return self.check("out", tiny.mission)

    def hostile(self):
        """A report of robots whose names are meant to do harm."""
        with TinyMission() as tiny:
            for robot, name in zip("ab", HOSTILE):
                shutil.move(tiny.mission / robot, tiny.mission / name)
            return self.check("hostile", tiny.mission)

    def long(self):
        """A report of robots whose names are long, and differ only where they end."""
        with TinyMission() as tiny:
            return self.check("long", *(f"{LONG}{robot}={tiny.mission / robot}" for robot in "ab"))

    def fleet(self):
        """A report of eight robots, four that went each way of the tiny mission."""
        with TinyMission() as tiny:
            robots = [f"{way}{n}={tiny.mission / way}" for n in range(4) for way in "ab"]
            return self.check("fleet", *robots)

    def clouds(self):
        """A report of finished clouds in world coordinates: no pose of theirs says where a robot was."""
        with TinyMission() as tiny:
            made = run_kilter("submaps", tiny.mission, "--format", "pcd", "-o", tiny.folder / "finished")
            self.assertEqual(made.status, 0, made.stderr)
            for poses in (tiny.folder / "finished").glob("*/poses.tum"):
                rows = [line.split() for line in poses.read_text().splitlines() if not line.startswith("#")]
                for file, (_, *pose) in zip(sorted((poses.parent / "submaps").iterdir()), rows):
                    put_into_the_world(file, [float(number) for number in pose])
                poses.write_text("".join(f"{row[0]} 0 0 0 0 0 0 1\n" for row in rows))
            return self.check("clouds", tiny.folder / "finished")

    def alone(self):
        """A report of one submap, which meets no other."""
        with TinyMission() as tiny:
            return self.check("alone", tiny.copy("one"))

    def check_lines(self, script, *arguments):
        """Each line of a script of viewer/test as a test of its own; how many there were."""
        command = ["node", SOURCE_DIR / "viewer/test" / script, *arguments]
        done = subprocess.run(command, capture_output=True, text=True, timeout=540, check=False)
        lines = [json.loads(line) for line in done.stdout.splitlines()]
        self.assertEqual(done.returncode, 0, done.stderr)
        for line in lines:
            with self.subTest(line["name"]):
                self.assertTrue(line["ok"], line["error"])
        return len(lines)

    def test_it_has_an_answer_to_every_reason(self):
        self.assertGreaterEqual(self.check_lines("words_test.mjs"), 6)

    def test_the_report_does_what_it_shows(self):
        report = self.simulated()
        if b"built without its viewer" in report.read_bytes():
            self.skipTest("kilter was built without its viewer")
        pages = [report, self.hostile(), self.fleet(), self.clouds(), self.alone()]
        self.assertGreaterEqual(self.check_lines("report_test.mjs", *pages, self.shots), 28)

    def test_the_report_looks_right_on_paper_and_elsewhere(self):
        report = self.long()
        if b"built without its viewer" in report.read_bytes():
            self.skipTest("kilter was built without its viewer")
        self.assertGreaterEqual(self.check_lines("looks_test.mjs", report, self.alone(), self.fleet(), self.shots), 13)

    def test_the_report_command_writes_the_same_bytes(self):
        with TinyMission() as tiny:
            report = self.check("again", tiny.mission)
        out = self.folder / "again.html"
        for source in (report.parent, report.parent / "result.kilter"):
            run = run_kilter("report", source, "-o", out)
            self.assertEqual(run.status, 0, run.stderr)
            self.assertEqual(out.read_bytes(), report.read_bytes())


if __name__ == "__main__":
    main()
