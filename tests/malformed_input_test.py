# SPDX-FileCopyrightText: The kilter authors
# SPDX-License-Identifier: BSD-3-Clause
"""Whatever is wrong with a mission or a command line, `kilter check` says what and where, and ends with the right status."""

from __future__ import annotations

import shutil
import struct
import unittest
from collections.abc import Callable
from pathlib import Path

from kilter_runner import main, run_kilter
from tiny_mission import TinyMission

NAN = float("nan")


def pcd(points: str, body: bytes = b"") -> bytes:
    header = f"VERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH {points}\nHEIGHT 1\nPOINTS {points}\n"
    return header.encode() + b"DATA binary\n" + body


def ply(count: str) -> bytes:
    properties = "property float x\nproperty float y\nproperty float z\n"
    return f"ply\nformat binary_little_endian 1.0\nelement vertex {count}\n{properties}end_header\n".encode()


def poses(change: Callable[[list[str]], list[str]]) -> Callable[[Path], None]:
    """Damages the lines of robot a's poses."""
    def apply(mission: Path) -> None:
        file = mission / "a" / "poses.tum"
        file.write_text("\n".join(change(file.read_text().splitlines())) + "\n")
    return apply


def scan(number: int, suffix: str, content: bytes) -> Callable[[Path], None]:
    """Replaces one of robot a's scans, all three of which get the suffix."""
    def apply(mission: Path) -> None:
        for i, file in enumerate(sorted((mission / "a" / "scans").iterdir())):
            if suffix != file.suffix:
                file.unlink()
            file.with_suffix(suffix).write_bytes(content if i == number or suffix != ".bin" else file.read_bytes())
    return apply


def scans(content: bytes) -> Callable[[Path], None]:
    """Replaces all of robot a's scans."""
    def apply(mission: Path) -> None:
        for file in (mission / "a" / "scans").iterdir():
            file.write_bytes(content)
    return apply


def remove(name: str) -> Callable[[Path], None]:
    def apply(mission: Path) -> None:
        path = mission / name
        shutil.rmtree(path) if path.is_dir() else path.unlink()
    return apply


# What is done to the mission, the code that begins the message, and a part of the message.
DAMAGES = {
    "no robot": (remove("a"), "empty-input", "no robot"),
    "no poses": (remove("a/poses.tum"), "not-found", "poses"),
    "no scan": (lambda mission: [file.unlink() for file in (mission / "a" / "scans").iterdir()], "empty-input", "a/scans"),
    "a pose less": (poses(lambda lines: lines[:2]), "count-mismatch", "2"),
    "a pose more": (poses(lambda lines: [*lines, lines[-1]]), "count-mismatch", "4"),
    "no pose": (poses(lambda lines: []), "empty-input", "poses.tum"),
    "a word for a number": (poses(lambda lines: [lines[0], lines[1].replace(" ", " abc ", 1), lines[2]]), "parse",
                            "poses.tum:2"),
    "seven columns": (poses(lambda lines: [line.rsplit(" ", 1)[0] for line in lines]), "parse", "poses.tum:1"),
    "a pose that is not finite": (poses(lambda lines: [lines[0], "1 nan 0 0 0 0 0 1", lines[2]]), "invalid-pose",
                                  "poses.tum:2"),
    "a quaternion of zeros": (poses(lambda lines: [*lines[:2], "2 0 0 0 0 0 0 0"]), "invalid-pose", "poses.tum:3"),
    "a scan cut short": (scan(1, ".bin", b"x" * 1601), "truncated", "000001.bin"),
    "an empty scan": (scan(2, ".bin", b""), "truncated", "000002.bin"),
    "a pcd with a negative count": (scan(0, ".pcd", pcd("-5")), "parse", "000000.pcd"),
    "a pcd that claims four billion points": (scan(0, ".pcd", pcd("4000000000", b"1234")), "truncated", "000000.pcd"),
    "a pcd that claims more than there is": (scan(0, ".pcd", pcd("99999999999999999999")), "parse", "000000.pcd"),
    "a pcd without a header": (scan(0, ".pcd", b"\x00" * 64), "", "000000.pcd"),
    "a ply with a negative count": (scan(0, ".ply", ply("-1")), "parse", "000000.ply"),
    "a ply that claims four billion points": (scan(0, ".ply", ply("4000000000")), "truncated", "000000.ply"),
    "scans of nothing but NaN": (scans(struct.pack("<4f", NAN, NAN, NAN, 0) * 100), "invalid-points", "000000.bin"),
    "georeferenced scans": (scans(struct.pack("<4f", 691e3, 5334e3, 500, 0) * 100), "invalid-points", "georeferenced"),
    "a format that nobody reads": (scan(0, ".laz", b"LASF"), "empty-input", "only 000000.laz"),
}

# Arguments behind `check MISSION`, the status, the code and a part of the message.
ARGUMENTS = {
    "an unknown key": (["--set", "tolerence=0.1"], 2, "config", '"tolerance"'),
    "a unit that does not fit": (["--set", "tolerance=5 deg"], 2, "config", "5 deg"),
    "a value out of range": (["--set", "alpha=2"], 2, "config", "alpha"),
    "a word for a number": (["--set", "tolerance=small"], 2, "config", "small"),
    "a choice that is none": (["--set", "fit=best"], 2, "config", "moments"),
    "a setting without a value": (["--set", "tolerance"], 2, "usage", "key=value"),
    "no such configuration": (["--config", "no/such.toml"], 2, "config", "no/such.toml"),
    "an unknown option": (["--jsn"], 2, "usage", "--json"),
    "no jobs": (["--jobs", "0"], 2, "usage", "jobs"),
    "half a job": (["--jobs", "0.5"], 2, "usage", "jobs"),
    "a size without a meaning": (["--memory", "4 bananas"], 2, "usage", "--memory"),
    "another preset": (["--preset", "paper"], 2, "usage", "preset"),
    "another fail-on": (["--fail-on", "monday"], 2, "usage", "fail-on"),
    "a sensor on no robot": (["--set", "T_body_sensor.zz=0 0 0 0 0 0 1"], 2, "config", "zz"),
    "a sensor beyond the Moon": (["--set", "T_body_sensor=1e19 0 0 0 0 0 1"], 2, "config", "beyond 1e+08 m"),
    "nothing is ever occupied": (["--set", "clamping_max=0.5", "--set", "occupancy_threshold=0.99"], 2, "config",
                                 "occupancy_threshold"),
    "a reach of thousands of voxels": (["--set", "d=100", "--set", "resolution=0.05"], 2, "config", "d: expected"),
    "nothing is ever free": (["--set", "clamping_min=0.5"], 2, "config", "occupancy_threshold"),
    "no range at all": (["--set", "min_range=50", "--set", "max_range=10"], 2, "config", "min_range"),
    "a sensor of six numbers": (["--set", "T_body_sensor=0 0 0 0 0 1"], 2, "config", "6 numbers"),
    "poses without a name": (["--poses", ""], 2, "usage", '--poses: expected a name, found ""'),
    "cuts without a name": (["--cuts", ""], 2, "usage", '--cuts: expected a name, found ""'),
    "a configuration without a name": (["--config", ""], 2, "usage", '--config: expected a name, found ""'),
    "poses of nobody": (["--poses", "no/such/poses"], 3, "not-found", "no/such/poses"),
    "cuts of nothing": (["--cuts", "no/such/result"], 3, "not-found", "no/such/result"),
}


class Malformed(unittest.TestCase):
    @classmethod
    def setUpClass(cls) -> None:
        cls.tiny = cls.enterClassContext(TinyMission())
        cls.out = cls.tiny.folder / "out"

    def refused(self, status: int, code: str, part: str, *arguments: object) -> None:
        """Runs `check` and expects a message and nothing else."""
        run = run_kilter("check", *arguments, "-o", self.out, timeout_s=30)
        self.assertFalse(run.crashed)
        self.assertEqual(run.status, status, run.stdout + run.stderr)
        self.assertEqual(run.stdout, "")
        self.assertTrue(run.stderr.startswith(f"{code}:" if code else ""), run.stderr)
        self.assertIn(part, run.stderr)
        self.assertFalse(self.out.exists())
        name = run.stderr.split(":", 1)[0]
        self.assertEqual(run_kilter("explain", name).status, 0, f"'{name}' has no explanation")

    def test_every_damage_is_named_with_its_place(self):
        for name, (damage, code, part) in DAMAGES.items():
            with self.subTest(name):
                mission = self.tiny.copy("damaged")
                damage(mission)
                self.refused(3, code, part, mission)

    def test_every_mistake_on_the_command_line_is_named(self):
        mission = self.tiny.copy("good")
        for name, (arguments, status, code, part) in ARGUMENTS.items():
            with self.subTest(name):
                self.refused(status, code, part, mission, *arguments)

    def test_a_source_that_is_not_there_is_named(self):
        self.refused(3, "not-found", "no/such/mission", "no/such/mission")

    def test_a_file_for_a_folder_is_named(self):
        self.refused(3, "unsupported", "poses.tum", self.tiny.mission / "a" / "poses.tum")

    def test_bags_that_are_none_are_named(self):
        corpus = Path(__file__).resolve().parent.parent / "fuzz" / "corpus"
        whole = (corpus / "rosbag1" / "plain").read_bytes()
        for name, content, code in (("none.bag", b"none", "parse"), ("old.bag", b"#ROSBAG V1.2\n", "unsupported"),
                                    ("none.mcap", b"none", "parse"), ("none.db3", b"none" * 200, "parse"),
                                    ("empty.db3", b"", "parse"), ("packed.db3.zstd", b"", "unsupported"),
                                    ("cut.bag", whole[:400], "empty-input"),
                                    ("damaged.bag", whole.replace(b"conn=", b"coon="), "parse")):
            with self.subTest(name):
                file = self.tiny.folder / name
                file.write_bytes(content)
                self.refused(3, code, name, file)
        file = self.tiny.folder / "good.bag"
        file.write_bytes(whole)
        self.refused(3, "not-found", "/odom (nav_msgs/Odometry, 2 messages)", f"{file}#/points_raw")

    def test_a_name_given_twice_is_a_usage_error(self):
        self.refused(2, "usage", '"x"', f"x={self.tiny.mission / 'a'}", f"x={self.tiny.mission / 'b'}")

    def test_no_source_is_a_usage_error(self):
        self.refused(2, "usage", "SOURCE")

    def test_a_robot_called_global_cannot_have_its_map_beside_the_global_one(self):
        self.refused(2, "usage", "global", f"global={self.tiny.mission / 'a'}", "--maps")

    def test_a_configuration_names_file_and_line(self):
        mission = self.tiny.copy("good")
        config = self.tiny.folder / "keys.toml"
        for text, part in (("tolerance = 0.1\nresolutoin = 0.2\n", "keys.toml:2: there is no key"),
                           ("\n\ntolerance = -1\n", "keys.toml:3: tolerance"),
                           ("tolerance = [0.1]\n", "keys.toml:1: tolerance"),
                           ("tolerance = \n", "keys.toml:1: "),
                           ("[T_body_sensor]\na = [0, 0, 0, 0, 0, 0]\n", "keys.toml:2: T_body_sensor"),
                           ("T_body_sensor = [0, 0, 0, 0, 0, 0, 2]\n", "keys.toml:1: T_body_sensor"),
                           ("T_body_sensor = [0, 0, 0, 0, 0, 0, true]\n", "keys.toml:1: T_body_sensor")):
            with self.subTest(text):
                config.write_text(text)
                self.refused(2, "config", part, mission, "--config", config)

    def test_a_result_that_is_none_cannot_give_cuts(self):
        broken = self.tiny.folder / "broken.json"
        for text, code in (("{", "parse"), ('{"schema": "other/1"}', "unsupported"), ("[" * 100000, "parse")):
            with self.subTest(text[:30]):
                broken.write_text(text)
                self.refused(3, code, "broken.json", self.tiny.mission, "--cuts", broken)
        takes = "try: --cuts takes the output folder of `kilter check`, or its result.json"
        (self.tiny.folder / "result.kilter").write_bytes(b"KILTER archive \x00\x01")
        for name in ("result.kilter", "broken.json"):
            self.refused(3, "parse", takes, self.tiny.mission, "--cuts", self.tiny.folder / name)

    def test_a_file_of_poses_is_no_folder_of_robots_poses(self):
        file = self.tiny.mission / "a" / "poses.tum"
        said = f"{file}: expected a folder that holds ROBOT/poses.* for each robot, found a file\n"
        self.refused(3, "unsupported", said, self.tiny.mission, "--poses", file)

    def test_poses_are_looked_for_below_the_robots_names(self):
        folder = self.tiny.mission / "a"
        said = f"{folder}: expected a/poses.* in it, found no a\n  try: name the folder above the robots' folders"
        self.refused(3, "not-found", said, self.tiny.mission, "--poses", folder)
        empty = self.tiny.folder / "nobodys poses"
        empty.mkdir()
        said = f"{empty}: expected a/poses.* in it, found no a\n  try: call the robot as its folder there is called"
        self.refused(3, "not-found", said, self.tiny.mission, "--poses", empty)
        takes = "try: --poses takes a folder that holds ROBOT/poses.* for each robot"
        self.refused(3, "not-found", takes, self.tiny.mission, "--poses", empty / "absent")

    def test_a_scan_without_one_usable_point_is_told_of(self):
        mission = self.tiny.copy("patchy")
        (mission / "a" / "scans" / "000000.bin").write_bytes(struct.pack("<4f", NAN, NAN, NAN, 0.0) * 50)
        run = run_kilter("check", mission, "-o", self.tiny.folder / "patchy-out")
        self.assertEqual(run.status, 4)
        self.assertIn("robot a: 50 points were left out", run.stderr)

    def test_no_submaps_are_written_of_a_robot_without_one_usable_point(self):
        mission = self.tiny.copy("empty-robot")
        scans = sorted((mission / "a" / "scans").iterdir())
        for scan in scans:
            scan.write_bytes(struct.pack("<4f", NAN, NAN, NAN, 0.0) * 50)
        out = self.tiny.folder / "empty-robot-out"
        run = run_kilter("submaps", mission, "-o", out)
        self.assertEqual(run.status, 3, run.stderr)
        self.assertIn(scans[0].name, run.stderr)
        self.assertFalse(out.exists() and any(out.iterdir()))

    def test_a_submap_without_surface_is_told_of(self):
        mission = self.tiny.copy("near", scans=1)
        (mission / "a" / "scans" / "000000.bin").write_bytes(struct.pack("<4f", 0.1, 0.0, 0.0, 0.0) * 50)
        run = run_kilter("check", mission, "-o", self.tiny.folder / "near-out")
        self.assertEqual(run.status, 4)
        self.assertIn("submap a/1 holds no surface", run.stderr)
        run = run_kilter("check", self.tiny.mission, "-o", self.tiny.folder / "bare-out", "--set", "min_range=50")
        self.assertEqual(run.status, 4, run.stderr)
        self.assertEqual(run.stderr.count("surface"), 2, run.stderr)
        self.assertIn("note: robot b: none of its 3 submaps holds a surface\n", run.stderr)
        self.assertIn("\nNext        widen min_range and max_range: they leave no surface to any submap of a, b\n", run.stdout)

    def test_bytes_that_steer_a_terminal_never_reach_it(self):
        name = "\x1b[2Jx"
        robot = self.tiny.folder / name
        shutil.copytree(self.tiny.mission / "a", robot)
        run = run_kilter("check", robot, "-o", self.out)
        self.assertEqual(run.status, 3)
        self.assertNotIn("\x1b", run.stderr)


if __name__ == "__main__":
    main()
