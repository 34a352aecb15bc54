# SPDX-FileCopyrightText: The kilter authors
# SPDX-License-Identifier: BSD-3-Clause
"""`kilter simulate` from outside: layout, formats, repeatability, refusals, and that `check` sees what was planted."""

import cmath
import json
import math
import os
import re
import resource
import shutil
import signal
import subprocess
import tempfile
import unittest
from pathlib import Path

from kilter_runner import interrupt_kilter, kilter_binary, main, run_kilter

QUICK = ("--scan-step", "1.5", "--columns", "360")


def simulator_is_built() -> bool:
    return "not built in" not in run_kilter("--help").stdout


def tree_bytes(folder: Path) -> dict[str, bytes]:
    """Content of every file below a folder by its relative name."""
    return {str(path.relative_to(folder)): path.read_bytes() for path in sorted(folder.rglob("*")) if path.is_file()}


@unittest.skipUnless(simulator_is_built(), "this kilter has no simulator")
class Simulate(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)

    def simulate(self, name, *arguments):
        run = run_kilter("simulate", *arguments, "-o", self.folder / name)
        self.assertEqual(run.status, 0, run.stderr)
        return self.folder / name

    def test_a_mission_has_the_promised_layout_and_info_reads_it(self):
        for form in ("bin", "pcd"):
            with self.subTest(form):
                made = self.simulate(form, "office", "--robots", "3", "--format", form, *QUICK)
                for robot in "abc":
                    scans = sorted(path.name for path in (made / "mission" / robot / "scans").iterdir())
                    self.assertEqual(scans[0], f"000000.{form}")
                    for side in ("mission", "truth"):
                        lines = (made / side / robot / "poses.tum").read_text(encoding="utf-8").splitlines()
                        self.assertEqual(len(lines), len(scans))
                        self.assertTrue(all(len(line.split()) == 8 for line in lines))
                info = run_kilter("info", made / "mission", "--json")
                self.assertEqual(info.status, 0, info.stderr)
                self.assertEqual([robot["name"] for robot in json.loads(info.stdout)["robots"]], ["a", "b", "c"])

    def test_the_same_seed_gives_the_same_bytes_for_any_jobs_and_another_seed_does_not(self):
        one = tree_bytes(self.simulate("one", "carpark", "--seed", "5", "--jobs", "1", *QUICK))
        two = tree_bytes(self.simulate("two", "carpark", "--seed", "5", "--jobs", "2", *QUICK))
        other = tree_bytes(self.simulate("other", "carpark", "--seed", "6", *QUICK))
        self.assertEqual(one, two)
        self.assertNotEqual(one["mission/a/scans/000000.bin"], other["mission/a/scans/000000.bin"])

    def test_faults_are_listed_with_the_size_asked_for(self):
        made = self.simulate("faulty", "office", "--fault", "slip:a:0.4:0.5", "--fault", "missed-closure:b:0.7", *QUICK)
        listed = json.loads((made / "truth" / "faults.json").read_text(encoding="utf-8"))
        self.assertEqual(listed["schema"], "kilter.faults/1")
        slip, missed = listed["faults"]
        self.assertEqual((slip["kind"], slip["robot"]), ("slip", "a"))
        self.assertAlmostEqual(slip["size_m"], 0.4, delta=0.05)
        self.assertEqual((missed["kind"], missed["robot"], missed["against_robot"]), ("missed-closure", "b", "b"))
        self.assertAlmostEqual(missed["size_m"], 0.7, delta=0.05)

    def test_faults_tell_which_way_the_map_is_off(self):
        made = self.simulate("ways", "office", "--fault", "slip:a:0.4:0.5", "--fault", "frame-offset:b:0.5", *QUICK)
        poses = {(side, robot): [[float(word) for word in line.split()[1:]] for line in
                                 (made / side / robot / "poses.tum").read_text(encoding="utf-8").splitlines()]
                 for side in ("mission", "truth") for robot in "ab"}

        def headed(side: str, robot: str, scan: int) -> tuple[complex, complex]:
            """Place in the plane, and the direction of the sensor's x axis there."""
            x, y, _, qx, qy, qz, qw = poses[side, robot][scan]
            return complex(x, y), complex(1 - 2 * (qy * qy + qz * qz), 2 * (qx * qy + qz * qw))

        for fault in json.loads((made / "truth" / "faults.json").read_text(encoding="utf-8"))["faults"]:
            self.assertAlmostEqual(math.hypot(*fault["shift_m"]), fault["size_m"], delta=0.01)
            self.assertAlmostEqual(math.hypot(*fault["turn_rad"]), fault["size_rad"], delta=1e-9)
            scan, against = (fault["robot"], fault["scan"]), (fault["against_robot"], fault["against_scan"])
            (here, ahead), (there, ahead_there) = headed("mission", *scan), headed("mission", *against)
            (true_here, true_ahead), (true_there, true_ahead_there) = headed("truth", *scan), headed("truth", *against)
            turned = ahead_there / true_ahead_there
            shift = here - (there + (true_here - true_there) * turned)
            self.assertAlmostEqual(abs(shift - complex(*fault["shift_m"][:2])), 0, delta=0.01)
            self.assertAlmostEqual(cmath.phase(ahead / (true_ahead * turned)), fault["turn_rad"][2], delta=0.005)

    def test_a_size_that_was_asked_for_and_missed_is_told(self):
        arguments = ("factory", "--scan-step", "1.5", "--columns", "36", "--seed", "2", "--replace", "-o", self.folder / "missed")
        asked = ("--fault", "frame-offset:b:0.4", "--fault", "slip:a:0.3")
        run = run_kilter("simulate", *arguments, *asked)
        offset, _ = json.loads((self.folder / "missed" / "truth" / "faults.json").read_text(encoding="utf-8"))["faults"]
        self.assertGreater(abs(offset["size_m"] - 0.4), 0.04)
        told = f"note: frame-offset of robot b: asked for 0.4 m, and the map shows {offset['size_m']:.3g} m\n"
        self.assertEqual((run.status, run.stderr.count("note: "), run.stderr.count(told)), (0, 1, 1), run.stderr)
        for others in ((*asked, "--quiet"), ()):  # nothing of the scene's own faults, which nobody has asked for
            run = run_kilter("simulate", *arguments, *others)
            self.assertEqual((run.status, run.stderr.count("note: ")), (0, 0), run.stderr)

    def test_one_robot_is_counted_and_a_fault_of_another_names_the_last(self):
        run = run_kilter("simulate", "office", "-o", self.folder / "alone", "--robots", "1", "--fault", "none", *QUICK)
        self.assertRegex(run.stdout, r"^\d+ scans of 1 robot in ")
        run = run_kilter("simulate", "office", "-o", self.folder / "b", "--robots", "1", "--fault", "slip:b", *QUICK)
        self.assertEqual(run.status, 2)
        self.assertIn("no room for the fault slip: the last robot is a\n", run.stderr)

    def test_a_larger_office_has_its_own_faults_too(self):
        for scale in ("2", "5"):
            made = self.simulate("large", "office", "--scale", scale, "--scan-step", "4", "--columns", "36", "--replace")
            listed = json.loads((made / "truth" / "faults.json").read_text(encoding="utf-8"))["faults"]
            self.assertEqual([fault["kind"] for fault in listed], ["slip", "frame-offset", "missed-closure"])

    def test_without_a_fault_the_estimate_is_the_truth_to_centimetres(self):
        made = self.simulate("clean", "office", "--fault", "none", *QUICK)
        for robot in "ab":
            poses = [[[float(word) for word in line.split()[1:4]] for line in
                      (made / side / robot / "poses.tum").read_text(encoding="utf-8").splitlines()]
                     for side in ("mission", "truth")]
            worst_m = max(max(abs(a - b) for a, b in zip(*pair)) for pair in zip(*poses))
            self.assertGreater(worst_m, 0.001)
            self.assertLess(worst_m, 0.15)

    def test_recordings_are_not_replaced(self):
        recorded = self.folder / "recorded" / "mission" / "robot" / "scans"
        recorded.mkdir(parents=True)
        (recorded / "000000.bin").write_bytes(b"what nobody has twice")
        run = run_kilter("simulate", "tunnel", "-o", self.folder / "recorded", "--replace", *QUICK)
        self.assertEqual(run.status, 2)
        self.assertIn("left alone", run.stderr)
        self.assertTrue((recorded / "000000.bin").exists())

    def test_an_earlier_mission_is_only_replaced_on_request(self):
        made = self.simulate("again", "tunnel", *QUICK)
        run = run_kilter("simulate", "tunnel", "-o", made, *QUICK)
        self.assertEqual(run.status, 2)
        self.assertIn("--replace", run.stderr)
        before = tree_bytes(made)
        self.simulate("again", "tunnel", "--replace", "--seed", "2", *QUICK)
        self.assertNotEqual(tree_bytes(made), before)

    def test_what_others_have_put_into_a_mission_is_not_replaced(self):
        made = self.simulate("shared", "tunnel", "--replace", *QUICK)
        scan = (made / "mission" / "a" / "scans" / "000000.bin").read_bytes()
        poses = (made / "mission" / "a" / "poses.tum").read_bytes()
        for name, content, told in (("mission/mine/poses.tum", poses, "mission/mine"), ("mission/e/scans/000000.bin", scan, "mission/e"),
                                    ("mission/a/poses_slam.tum", poses, None), ("mission/a/scans/900000.bin", scan, None),
                                    ("mission/result.json", b"{}", None), ("truth/mine/poses.tum", poses, "truth/mine"),
                                    ("truth/a/notes.txt", b"mine", None),
                                    ("mission/a/scans/000001.pcd", scan, None)):
            with self.subTest(name):
                file = made / name
                alone = not file.parent.exists()
                file.parent.mkdir(parents=True, exist_ok=True)
                file.write_bytes(content)
                before = tree_bytes(made)
                run = run_kilter("simulate", "tunnel", "-o", made, "--replace", *QUICK)
                self.assertEqual((run.status, run.stdout), (2, ""), run.stderr)
                self.assertEqual(run.stderr, f"usage: {made / (told or name)}: nothing in truth/ says that simulate wrote this; it is left alone\n"
                                             "  try: move it away, or choose another folder\n")
                self.assertEqual(tree_bytes(made), before)
                if alone:
                    shutil.rmtree(made / told)
                else:
                    file.unlink()
        for name in ("mission/a/poses.tum", "mission/a/scans/000000.bin", "mission/a/scans", "truth/a/poses.tum", "truth/a", "mission"):
            for kind in ("folder", "symlink"):
                with self.subTest(name, kind=kind):
                    file, kept = made / name, self.folder / "kept"
                    if kind == "folder" and file.is_dir():
                        continue
                    file.rename(kept)
                    file.mkdir() if kind == "folder" else file.symlink_to(kept)
                    run = run_kilter("simulate", "tunnel", "-o", made, "--replace", *QUICK)
                    self.assertEqual((run.status, run.stdout), (2, ""), run.stderr)
                    what = "this is a symlink, and simulate makes none" if kind == "symlink" else "nothing in truth/ says"
                    self.assertIn(f"{file}: {what}" if name != "truth/a/poses.tum" or kind == "symlink" else what, run.stderr)
                    file.rmdir() if kind == "folder" else file.unlink()
                    kept.rename(file)
        self.simulate("shared", "tunnel", "--replace", "--format", "pcd", *QUICK)
        self.simulate("shared", "office", "--replace", *QUICK)

    def test_what_does_not_exist_is_refused_with_the_nearest_name(self):
        for arguments, hint in ((["offise"], "did you mean office?"), (["office", "--beams", "17"], "16, 32 or 64"),
                                (["office", "--fault", "gremlin"], "slip"), (["office", "--robots", "9"], "robots"),
                                (["office", "--fault", "slip:a:-1"], "above 0"),
                                (["office", "--fault", "slip:a:0.4:2"], "AT must be a share of the robot's scans, 0 to 1"),
                                (["office", "--fault", "frame-offset:b:0.4:0.5"], "there is no AT"),
                                (["office", "--fault", "none", "--fault", "slip"], "other faults are asked for as well"),
                                (["office", "--fault", "slip", "--fault", "none"], "other faults are asked for as well"),
                                (["office", "--fault", "wrong-closure:a:100"], "with the fault wrong-closure of 100 m (robot a) "),
                                (["office", "--set", "colums=3"], "colums"),
                                (["tunnel", "--robots", "1", "--fault", "frame-offset:b"], "robot"),
                                (["carpark", "--scan-step", "20"], "--fault none"),
                                (["paper-indoor", "--robots", "4"], "paper-indoor has its own size and two robots, found robots 4"),
                                (["paper-outdoor", "--scale", "3"], "paper-outdoor has its own size and two robots, found scale 3")):
            with self.subTest(arguments):
                run = run_kilter("simulate", *arguments, "-o", self.folder / "refused")
                self.assertEqual(run.status, 2, run.stderr)
                self.assertIn(hint, run.stderr)
                self.assertFalse((self.folder / "refused").exists())

    def test_a_run_that_is_stopped_or_fails_leaves_what_was_there(self):
        earlier = self.simulate("earlier", "tunnel", *QUICK)
        before = tree_bytes(earlier)
        fresh = self.folder / "fresh"
        limit = lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (65536, 65536))  # noqa: E731
        for folder, number in ((earlier, signal.SIGTERM), (fresh, signal.SIGHUP)):
            run = interrupt_kilter(number, "simulate", "office", "-o", folder, "--replace", "--jobs", "1")
            self.assertEqual((run.status, run.stdout), (128 + number, ""), run.stderr)
            self.assertRegex(run.stderr, r"(?m)^cancelled: ")
            full = subprocess.run([str(kilter_binary()), "simulate", "office", "-o", str(folder), "--replace"],
                                  capture_output=True, text=True, preexec_fn=limit, check=False)
            self.assertEqual((full.returncode, full.stdout), (5, ""), full.stderr)
            self.assertRegex(full.stderr, "^no-space: " + re.escape(str(folder / "mission" / "a" / "scans")) + "/000000.bin: ")
        self.assertEqual(tree_bytes(earlier), before)
        self.assertEqual(sorted(path.name for path in earlier.iterdir()), ["mission", "truth"])
        self.assertFalse(fresh.exists())

    def test_more_jobs_than_processors_are_nothing_to_talk_about(self):
        allowed = os.sched_getaffinity(0)
        self.addCleanup(os.sched_setaffinity, 0, allowed)
        os.sched_setaffinity(0, {min(allowed)})
        run = run_kilter("simulate", "office", "-o", self.folder / "jobs", "--jobs", "5", "--quiet", *QUICK)
        self.assertEqual((run.status, run.stderr), (0, ""))

    def test_numbers_that_are_none_or_out_of_range_are_refused(self):
        whole = "expected a whole number from 0 to 18446744073709551615"
        for option, values, words in (("--range-noise", ("nan", "-0.1", "inf", "2"), "expected a number from 0 to 1"),
                                      ("--motion-residual", ("nan", "1.5", ""), "expected a number from 0 to 1"),
                                      ("--scan-step", ("nan", "-nan", "0", "1e-9", "0.049", "101", "1 m"),
                                       "expected a number from 0.05 to 100"),
                                      ("--robots", ("0", "6", "2.0", "1e3", ""), "expected a whole number from 1 to 5"),
                                      ("--columns", ("35", "7201", "1e3", "nan"), "expected a whole number from 36 to 7200"),
                                      ("--beams", ("17", "1e3", "nan", ""), "expected 16, 32 or 64"),
                                      ("--scale", ("nan", "0.4", "11"), "expected a number from 0.5 to 10"),
                                      ("--seed", ("-1", "18446744073709551616", "1e3", "0x1", "nan", ""), whole)):
            for value in values:
                with self.subTest(option=option, value=value):
                    run = run_kilter("simulate", "office", "-o", self.folder / "refused", f"{option}={value}" if value else option,
                                     *([] if value else [""]))
                    self.assertEqual((run.status, run.stdout), (2, ""))
                    self.assertTrue(run.stderr.startswith(f'usage: {option}: {words}, found "{value}"\n'), run.stderr)
                    self.assertFalse((self.folder / "refused").exists())
        largest = self.simulate("largest", "tunnel", "--seed", 2**64 - 1, "--scan-step", 4, "--columns", 36)
        self.assertEqual(json.loads((largest / "truth" / "faults.json").read_text())["seed"], 2**64 - 1)

    def test_check_finds_a_planted_slip_and_calls_the_truth_consistent(self):
        made = self.simulate("office", "office", "--seed", "2", "--fault", "slip:a:0.5:0.6", "--columns", "900")
        found = run_kilter("check", made / "mission", "-o", self.folder / "found")
        self.assertEqual(found.status, 1, found.stderr)
        truth = run_kilter("check", made / "mission", "--poses", made / "truth", "-o", self.folder / "truth-out")
        self.assertEqual(truth.status, 0, truth.stdout + truth.stderr)


if __name__ == "__main__":
    main()
