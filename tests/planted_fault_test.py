# SPDX-FileCopyrightText: The kilter authors
# SPDX-License-Identifier: BSD-3-Clause
"""The mission of scripts/demo: its planted fault is found, and the same scans under the right poses are clean."""

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


if __name__ == "__main__":
    main()
