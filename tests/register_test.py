#!/usr/bin/env python3
# SPDX-FileCopyrightText: The kilter authors
# SPDX-License-Identifier: BSD-3-Clause
"""kilter register, driven from outside: the pose it finds, what it says of itself, what it refuses."""
import json
import math
import pathlib
import shutil
import struct
import tempfile
import unittest

from kilter_runner import main, run_kilter


def room():
    """Points of a furnished L-shaped room, 4 cm apart, that looks like itself in one pose only."""
    points = []

    def patch(corner, u, v):
        steps_u, steps_v = (max(1, round(math.dist((0, 0, 0), w) / 0.04)) for w in (u, v))
        for i in range(steps_u):
            for j in range(steps_v):
                points.append([c + a * i / steps_u + b * j / steps_v for c, a, b in zip(corner, u, v)])

    patch((0, 0, 0), (8, 0, 0), (0, 6, 0))
    for corner, along in (((0, 0, 0), (8, 0, 0)), ((0, 0, 0), (0, 6, 0)), ((8, 0, 0), (0, 3.5, 0)),
                          ((5, 3.5, 0), (3, 0, 0)), ((5, 3.5, 0), (0, 2.5, 0)), ((0, 6, 0), (5, 0, 0)),
                          ((2, 2, 0), (0.9, 0, 0)), ((2, 2, 0), (0, 0.6, 0)), ((6.2, 1.1, 0), (0.5, 0.5, 0))):
        patch(corner, along, (0, 0, 2.5))
    return points


def write_bin(path, points):
    path.write_bytes(b"".join(struct.pack("<4f", *point, 0.0) for point in points))


def moved_into_source(points, x, y, yaw):
    """The points in the frame of a source that stands at (x, y, yaw) of the target."""
    c, s = math.cos(yaw), math.sin(yaw)
    return [(c * (p[0] - x) + s * (p[1] - y), -s * (p[0] - x) + c * (p[1] - y), p[2]) for p in points]


class RegisterTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.root = pathlib.Path(cls.folder.name)
        write_bin(cls.root / "target.bin", room())
        write_bin(cls.root / "source.bin", moved_into_source(room(), 1.8, -0.9, 0.25))

    @classmethod
    def tearDownClass(cls):
        cls.folder.cleanup()

    def register(self, *options):
        return run_kilter("register", self.root / "target.bin", self.root / "source.bin", *options)

    def test_finds_the_pose_from_afar_and_says_how_sure_it_is(self):
        done = self.register("--json")
        self.assertEqual(done.status, 0, done.stderr)
        said = json.loads(done.stdout)
        self.assertTrue(said["converged"])
        x, y, z, _, _, qz, qw = said["T_target_source"]
        self.assertAlmostEqual(x, 1.8, delta=0.02)
        self.assertAlmostEqual(y, -0.9, delta=0.02)
        self.assertAlmostEqual(z, 0.0, delta=0.02)
        self.assertAlmostEqual(2 * math.atan2(qz, qw), 0.25, delta=0.005)
        self.assertEqual(len(said["covariance"]), 36)
        self.assertLess(math.sqrt(said["covariance"][0]), 0.05)
        self.assertEqual(said["unobservable"], [])
        self.assertLess(said["ambiguity"], 0.7)

    def test_what_is_bent_is_not_said_to_be_known_to_millimetres(self):
        hall = [(2 * x, 2 * y, z) for x, y, z in room()]
        write_bin(self.root / "hall.bin", hall)
        write_bin(self.root / "bent.bin", [(x, y + (0.5 if x > 9 else 0.0), z) for x, y, z in hall])
        both = self.root / "hall.bin", self.root / "bent.bin"
        said = json.loads(run_kilter("register", *both, "--json").stdout)
        self.assertGreater(said["bend_m"], 0.1)
        self.assertGreater(math.sqrt(said["covariance"][7]), 0.1)
        self.assertIn("stay apart whatever the pose", run_kilter("register", *both).stdout)

    def test_writes_the_aligned_cloud(self):
        path = self.root / "aligned.ply"
        self.assertEqual(self.register("-o", path).status, 0)
        header, _, body = path.read_bytes().partition(b"end_header\n")
        self.assertIn(f"element vertex {len(room())}".encode(), header)
        first = struct.unpack("<3d", body[:24])
        self.assertLess(math.dist(first, room()[0]), 0.05)

    def test_takes_trees_too(self):
        poses = "0 0 0 0 0 0 0 1\n"
        for name in ("target", "source"):
            scans = self.root / name / "scans"
            scans.mkdir(parents=True)
            shutil.copy(self.root / f"{name}.bin", scans / "000000.bin")
            (scans.parent / "poses.tum").write_text(poses)
        made = run_kilter("submaps", self.root / "target", self.root / "source", "-o", self.root / "trees")
        self.assertEqual(made.status, 0, made.stderr)
        trees = [self.root / "trees" / name / "submaps" / "000000.ot" for name in ("target", "source")]
        done = run_kilter("register", *trees, "--json")
        self.assertEqual(done.status, 0, done.stderr)
        x, y, *_ = json.loads(done.stdout)["T_target_source"]
        self.assertLess(math.dist((x, y), (1.8, -0.9)), 0.1)  # a cell: centres are all that a tree has

    def test_same_bytes_for_any_number_of_threads(self):
        self.assertEqual(self.register("--json", "--jobs", "1").stdout, self.register("--json", "--jobs", "2").stdout)

    def test_verbose_says_when_it_begins_and_ends(self):
        run = self.register("--verbose")
        self.assertEqual(run.stderr, "registration: 1 of 3 (33 %)\nregistration: 3 of 3 (100 %)\n")
        self.assertEqual(self.register("--verbose", "--quiet").stderr, "")

    def test_refuses_what_it_cannot_use(self):
        done = run_kilter("register", self.root / "target.bin", self.root / "none.bin")
        self.assertEqual(done.status, 3)
        self.assertIn("none.bin", done.stderr)
        names = "a file that ends in .bin, .pcd, .ply, .las, .ot or .bt"
        for name in ("notes.txt", "scan.laz"):
            (self.root / name).write_text("")
        for name, said in (("none", "not-found: {}: there is no such file or folder\n"),
                           ("none.ot", "not-found: {}: there is no such file or folder\n"),
                           ("scan.laz", "unsupported: {}: this is a format that kilter does not read\n  try: decompress"),
                           ("notes.txt", f"unsupported: {{}}: expected {names}\n"),
                           (".", f"unsupported: {{}}: expected {names}, found a folder\n")):
            done = run_kilter("register", self.root / name, self.root / "source.bin")
            self.assertEqual(done.status, 3)
            self.assertTrue(done.stderr.startswith(said.format(self.root / name)), done.stderr)
        done = self.register("--init", "1 2 3")
        self.assertEqual(done.status, 2)
        self.assertIn("--init: expected x y z qx qy qz qw", done.stderr)
        for far in ("1e300", "1e19", "-2e8"):
            done = self.register("--init", f"0 {far} 0 0 0 0 1")
            self.assertEqual(done.status, 2)
            self.assertIn("usage: --init: expected x y z qx qy qz qw, found a position beyond 1e+08 m", done.stderr)
        write_bin(self.root / "utm.bin", [(691e3, 5334e3, 500.0)] * 100)
        done = run_kilter("register", self.root / "target.bin", self.root / "utm.bin")
        self.assertEqual(done.status, 3)
        self.assertIn(f"invalid-points: {self.root / 'utm.bin'}: none of its 100 points", done.stderr)
        (self.root / "empty.bin").write_bytes(b"")
        self.assertEqual(run_kilter("register", self.root / "target.bin", self.root / "empty.bin").status, 3)

    def test_ranges_apply_to_scans_only_and_name_the_one_that_they_leave_nothing_of(self):
        unused = "note: min_range and max_range apply to scans, and are not used without --scans\n"
        plain = self.register("--json")
        done = self.register("--json", "--set", "min_range=2")
        self.assertEqual((done.status, done.stdout, done.stderr), (0, plain.stdout, unused))
        self.assertEqual(self.register("--set", "max_range=5", "--quiet").stderr, "")
        self.assertEqual(self.register("--set", "max_range=9", "--scans").stderr, "")
        write_bin(self.root / "near.bin", [(p[0] % 1, p[1] % 1, p[2] % 1) for p in room()])
        for clouds in (("target.bin", "near.bin"), ("near.bin", "target.bin")):
            paths = [self.root / name for name in clouds]
            done = run_kilter("register", *paths, "--scans", "--set", "min_range=3")
            self.assertEqual((done.status, done.stdout), (3, ""))
            self.assertEqual(done.stderr, f"invalid-points: {self.root / 'near.bin'}: none of its {len(room())} points leaves "
                                          "a voxel between min_range (3 m) and max_range (60 m)\n  try: widen the two\n")

    def test_what_takes_long_is_told_before_it_does(self):
        cloud = self.root / "few.pcd"
        cloud.write_text("VERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH 2\nHEIGHT 1\n"
                         "VIEWPOINT 0 0 0 1 0 0 0\nPOINTS 2\nDATA ascii\n1 2 0\n2 1 0\n")
        said = "note: resolution = 0.02 m takes some 25 times the time and memory of 0.1 m; "
        for command in (("check", cloud, "-o", self.root / "out"), ("submaps", cloud, "-o", self.root / "cut"),
                        ("register", cloud, cloud)):
            self.assertEqual(run_kilter(*command, "--set", "resolution=2 cm").stderr.count(said), 1)
        self.assertNotIn(said, run_kilter(*command, "--set", "resolution=2 cm", "--quiet").stderr)
        self.assertNotIn("times the time", run_kilter(*command, "--set", "resolution=5 cm").stderr)

    def test_holds_its_two_maps_against_the_memory_it_may_take(self):
        done = self.register("--memory", "1K")
        self.assertEqual((done.status, done.stdout), (5, ""))
        self.assertRegex(done.stderr, r"out-of-memory: the two together need [\d.]+ MB, more than --memory allows")
        self.assertEqual(self.register("--memory", "1G", "--json").stdout, self.register("--json").stdout)

    def test_never_writes_onto_its_inputs_or_what_is_no_ply(self):
        (self.root / "aligned-link.ply").symlink_to(self.root / "source.bin")
        before = (self.root / "source.bin").read_bytes()
        for name, words in (("source.bin", "ends in .ply"), ("target.bin", "ends in .ply"), ("new", "ends in .ply"),
                            ("", 'expected a name, found ""'), ("aligned-link.ply", "would be overwritten")):
            done = self.register("-o", self.root / name if name else "")
            self.assertEqual((done.status, done.stdout), (2, ""), name)
            self.assertIn(words, done.stderr)
        self.assertEqual((self.root / "source.bin").read_bytes(), before)
        self.assertFalse((self.root / "new").exists())
        # What cannot be read is told of first only where the output's name is all right.
        self.assertEqual(run_kilter("register", self.root / "none.bin", self.root / "none.bin", "-o", "x.ply").status, 3)

    def test_a_cloud_of_somebody_else_stays_and_an_earlier_one_goes(self):
        aligned = self.root / "theirs.ply"
        aligned.write_text("ply\nformat ascii 1.0\ncomment frame submap, metres\nelement vertex 0\nend_header\n")
        before = aligned.read_bytes()
        done = self.register("-o", aligned)
        self.assertEqual((done.status, done.stdout), (2, ""), done.stderr)
        self.assertRegex(done.stderr, r"^usage: .*/theirs.ply: there is a file already, .*\n  try: name another file")
        self.assertEqual(aligned.read_bytes(), before)
        aligned.unlink()
        for _ in range(2):
            self.assertEqual(self.register("-o", aligned).status, 0)

    def test_what_cannot_be_written_is_found_out_before_any_work(self):
        none = self.root / "none.bin"
        (self.root / "folder.ply").mkdir()
        for name, words in (("x" * 252 + ".ply", "cannot be written: File name too long"),
                            ("missing/new.ply", "there is no such file or folder"),
                            ("target.bin/new.ply", "expected a folder, found a file"),
                            ("folder.ply", "a folder stands where a file is to be written")):
            done = run_kilter("register", none, none, "-o", self.root / name)
            self.assertEqual((done.status, done.stdout), (5, ""), done.stderr)
            self.assertIn(words, done.stderr)
            self.assertIn("\n  try: ", done.stderr)

    def test_says_so_when_nothing_meets(self):
        write_bin(self.root / "far.bin", [(p[0] + 500, p[1], p[2]) for p in room()])
        done = run_kilter("register", self.root / "target.bin", self.root / "far.bin", "--json")
        self.assertEqual(done.status, 0, done.stderr)
        said = json.loads(done.stdout)
        self.assertFalse(said["converged"])
        self.assertIsNone(said["T_target_source"])
        self.assertIsNone(said["covariance"])
        self.assertIsNone(said["unobservable"])
        aligned = self.root / "aligned.ply"
        done = run_kilter("register", self.root / "target.bin", self.root / "far.bin", "-o", aligned)
        self.assertEqual(done.status, 0, done.stderr)
        self.assertIn(f"{aligned} is not written", done.stderr)
        self.assertFalse(aligned.exists())
        done = run_kilter("register", self.root / "target.bin", self.root / "far.bin", "-o", aligned, "--quiet")
        self.assertEqual((done.status, done.stderr), (0, ""))


if __name__ == "__main__":
    main()
