# SPDX-FileCopyrightText: The kilter authors
# SPDX-License-Identifier: BSD-3-Clause
"""The mission of scripts/demo: its planted fault is found, and the same scans under the right poses are clean. So are
storeys that look alike."""

import json
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

from kilter_runner import SOURCE_DIR, main, run_kilter


class PlantedFault(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(folder.cleanup)
        cls.folder = Path(folder.name)
        subprocess.run([sys.executable, SOURCE_DIR / "scripts/make_tiny_mission.py", cls.folder], check=True)

    def check(self, name, *arguments):
        """Exit status and result.json of one run of `kilter check`."""
        run = run_kilter("check", self.folder / "mission", "-o", self.folder / name, *arguments)
        self.assertIn(run.status, (0, 1, 4), run.stderr)
        return run.status, json.loads((self.folder / name / "result.json").read_text(encoding="utf-8"))

    def test_every_pair_across_the_fault_is_inconsistent_and_no_other(self):
        status, result = self.check("as-mapped")
        self.assertEqual(status, 1)
        displaced = {submap["id"] for submap in result["submaps"]
                     if submap["robot"] == "b" and submap["first_scan"] >= 5}
        self.assertTrue(displaced)
        for pair in result["pairs"]:
            across = (pair["source"] in displaced) != (pair["target"] in displaced)
            self.assertEqual(pair["verdict"], "inconsistent" if across else "consistent", pair["reason"])
            self.assertAlmostEqual(pair["offset_m"], 0.4 if across else 0.0, delta=0.03)

    def test_the_right_poses_make_the_map_consistent(self):
        status, result = self.check("with-right-poses", "--poses", self.folder / "truth")
        self.assertEqual(status, 0)
        self.assertEqual(result["system"]["verdict"], "consistent")


    def test_a_robot_that_lies_off_as_a_whole_is_told_as_one(self):
        poses = self.folder / "moved"
        for robot, shift_m in (("a", 0.0), ("b", 0.5)):
            (poses / robot).mkdir(parents=True)
            rows = [line.split() for line in (self.folder / "truth" / robot / "poses.tum").read_text().splitlines()]
            text = "".join(" ".join([row[0], str(float(row[1]) + shift_m), *row[2:]]) + "\n" for row in rows
                           if row and not row[0].startswith("#"))
            (poses / robot / "poses.tum").write_text(text)
        status, result = self.check("moved-out", "--poses", poses)
        self.assertEqual(status, 1)
        self.assertEqual({pair["kind"] for pair in result["pairs"] if pair["verdict"] == "inconsistent"}, {"global"})
        [frame] = result["system"]["frames"]
        self.assertEqual((frame["target"], frame["source"]), ("a", "b"))
        self.assertEqual(frame["agreeing"], frame["witnesses"])
        self.assertAlmostEqual(frame["shift"][0], -0.5, delta=0.02)
        self.assertAlmostEqual(frame["offset_m"], 0.5, delta=0.02)
        slipped = self.check("slipped")[1]
        self.assertEqual(slipped["system"]["frames"], [], "some pairs ask for a motion, and some for none")


class StoreysThatLookAlike(unittest.TestCase):
    def test_under_their_right_poses_the_map_is_consistent_and_floors_are_not_held_against_ceilings(self):
        with tempfile.TemporaryDirectory() as scratch:
            folder = Path(scratch)
            made = run_kilter("simulate", "stairs", "-o", folder / "stairs", "--seed", "7", "--columns", "360",
                              "--scan-step", "1.2", "--quiet")
            self.assertEqual(made.status, 0, made.stderr)
            run = run_kilter("check", folder / "stairs" / "mission", "--poses", folder / "stairs" / "truth", "-o",
                             folder / "out", "--quiet")
            result = json.loads((folder / "out" / "result.json").read_text(encoding="utf-8"))
        self.assertEqual(result["system"]["verdict"], "consistent", run.stdout)
        fits_elsewhere = [pair for pair in result["pairs"] if (pair["offset_m"] or 0.0) > 2.0]
        another_storey = [pair for pair in result["pairs"] if "no free space speaks against" in pair["reason"]]
        self.assertGreater(len(another_storey), 5)
        for pair in fits_elsewhere + another_storey:
            self.assertEqual(pair["verdict"], "unverified", pair["reason"])
            self.assertLess(pair["p_inconsistent"] or 0.0, 0.5, pair["reason"])


if __name__ == "__main__":
    main()
