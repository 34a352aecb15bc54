# SPDX-FileCopyrightText: The kilter authors
# SPDX-License-Identifier: BSD-3-Clause
"""kilter submaps, driven from outside: what it writes reads back as what was written, and nobody's files are touched."""

from __future__ import annotations

import json
import os
import re
import resource
import signal
import struct
import subprocess
import unittest
from pathlib import Path

from kilter_runner import Run, interrupt_kilter, kilter_binary, main, run_kilter
from tiny_mission import TinyMission, bytes_below, read_result

FORMATS = ("ot", "bt", "pcd", "ply")


class Submaps(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.tiny = TinyMission().__enter__()

    @classmethod
    def tearDownClass(cls):
        cls.tiny.__exit__()

    def counts(self, source: Path, name: str) -> list[tuple[str, int, int]]:
        """What kilter counts when it writes a source's submaps: robot, submaps, occupied voxels."""
        run = run_kilter("submaps", source, "-o", self.tiny.folder / name, "--json", "--quiet", "--replace")
        self.assertEqual((run.status, run.stderr), (0, ""))
        told = json.loads(run.stdout)
        self.assertEqual((told["schema"], told["format"]), ("kilter.submaps/1", "ot"))
        return [(robot["name"], robot["submaps"], robot["occupied"]) for robot in told["robots"]]

    def write(self, name: str, *options: object) -> Path:
        folder = self.tiny.folder / name
        run = run_kilter("submaps", self.tiny.mission, "-o", folder, *options)
        self.assertEqual(run.status, 0, run.stderr)
        return folder

    def test_every_format_reads_back_as_the_same_voxels(self):
        before = self.counts(self.tiny.mission, "direct")
        self.assertEqual([row[:2] for row in before], [("a", 3), ("b", 3)])
        for kind in FORMATS:
            with self.subTest(kind):
                folder = self.write(kind, "--format", kind)
                for old, new in zip(before, self.counts(folder, f"again-{kind}"), strict=True):
                    self.assertEqual(new[:2], old[:2])
                    # A centroid on the border of two voxels may round into the other one.
                    self.assertAlmostEqual(new[2], old[2], delta=0.0 if kind in ("ot", "bt") else 0.002 * old[2])
        self.assertEqual(bytes_below(self.tiny.folder / "again-ot")["a/submaps/000002.ot"],
                         bytes_below(self.tiny.folder / "direct")["a/submaps/000002.ot"], "a tree comes back as it is")

    def test_check_finds_the_same_fault_in_trees(self):
        folder = self.write("checked")
        run = run_kilter("check", folder, "-o", self.tiny.folder / "out")
        self.assertEqual(run.status, 1, run.stderr)
        self.assertIn("mission, 6 submaps, 2 robots", run.stdout)
        result = read_result(self.tiny.folder / "out")
        self.assertEqual([submap["id"] for submap in result["submaps"]], ["a/1", "a/2", "a/3", "b/1", "b/2", "b/3"])
        self.assertIsNone(result["submaps"][0]["first_scan"])

    def test_keys_of_scans_that_finished_submaps_do_not_heed_are_named(self):
        folder = self.write("taken", "--format", "pcd", "--set", "min_range=1", "--set", "max_range=30")
        said = "note: finished submaps are taken as they are: {} no effect on those of a, b\n"
        for command in ("check", "submaps"):
            out = self.tiny.folder / f"taken-{command}"
            run = run_kilter(command, folder, "-o", out, "--set", "min_range=2", "--set", "max_range=9")
            self.assertIn(said.format("min_range, max_range have"), run.stderr)
            self.assertEqual(run.stderr.count("min_range"), 1, run.stderr)
            run = run_kilter(command, folder, "-o", self.tiny.folder / "quiet", "--set", "max_range=9", "--quiet")
            self.assertEqual(run.stderr, "")
        run = run_kilter("check", folder, "-o", self.tiny.folder / "out", "--set", "submap_distance=5")
        self.assertIn(said.format("submap_distance has"), run.stderr)
        run = run_kilter("check", self.tiny.mission, "-o", self.tiny.folder / "out", "--set", "min_range=1")
        self.assertNotIn("no effect", run.stderr)

    def test_what_is_written_is_a_mission_and_a_pose_graph(self):
        folder = self.write("layout", "--jobs", 1)
        names = [f"{robot}/{name}" for robot in "ab"
                 for name in ("poses.tum", *(f"submaps/{i:06}.ot" for i in range(3)))]
        self.assertEqual(sorted(bytes_below(folder)), sorted([*names, "submaps.g2o"]))
        self.assertEqual((folder / "submaps.g2o").read_text().count("VERTEX_SE3:QUAT"), 6)
        again = self.write("again", "--jobs", 4)
        self.assertEqual(bytes_below(again), bytes_below(folder), "the same bytes on any number of threads")

    def test_submaps_that_are_there_are_replaced_only_when_asked(self):
        folder = self.write("twice", "--set", "submap_distance=2")  # more of them than will be
        self.assertGreater(len(list((folder / "a" / "submaps").iterdir())), 3)
        (folder / "a" / "submaps" / "notes.txt").write_bytes(b"mine")
        before = bytes_below(folder)
        run = run_kilter("submaps", self.tiny.mission, "-o", folder)
        self.assertEqual((run.status, bytes_below(folder)), (2, before))
        self.assertIn("--replace", run.stderr)
        self.write("twice", "--replace", "--format", "ply")
        after = bytes_below(folder)
        self.assertEqual(after["a/submaps/notes.txt"], b"mine")
        self.assertFalse([name for name in after if name.endswith(".ot")])
        self.assertEqual(len([name for name in after if name.startswith("a/submaps/0")]), 3)

    def test_what_others_have_put_in_their_place_is_not_replaced(self):
        folder = self.write("foreign", "--format", "pcd", "--set", "resolution=0.3")
        poses = folder / "a" / "poses.tum"
        cloud = (folder / "a" / "submaps" / "000000.pcd").read_bytes()
        for name, content, words in (
                ("poses.tum", b"# my own graph slam poses\n" + poses.read_bytes(), "poses of somebody else"),
                ("submaps/000003.pcd", cloud, "a cloud of somebody else"),
                ("submaps/0000001.pcd", cloud, "a cloud of somebody else"),
                ("submaps/000001.ply", cloud, "more clouds than poses")):
            with self.subTest(name):
                file = folder / "a" / name
                ours = file.read_bytes() if file.exists() else None
                file.write_bytes(content)
                before = bytes_below(folder)
                run = run_kilter("submaps", self.tiny.mission, "-o", folder, "--replace")
                self.assertEqual(run.status, 2, run.stderr)
                self.assertTrue(bytes_below(folder) == before)
                self.assertIn(f"{file.parent if words.startswith('more') else file}: {words}", run.stderr)
                if ours is None:
                    file.unlink()
                else:
                    file.write_bytes(ours)
        poses.unlink()
        before = bytes_below(folder)
        run = run_kilter("submaps", self.tiny.mission, "-o", folder, "--replace")
        self.assertEqual(run.status, 2, "clouds that nobody knows the poses of")
        self.assertTrue(bytes_below(folder) == before)

    def run_as_anybody(self, folder: Path, *arguments: object) -> Run:
        """Runs kilter as a user to whom files can be closed, and whose `folder` is."""
        user = {}
        if os.geteuid() == 0:
            self.tiny.folder.chmod(0o755)
            for path in (folder, *folder.rglob("*")):
                os.chown(path, 65534, 65534)
            user = {"user": 65534, "group": 65534, "extra_groups": []}
        try:
            run = subprocess.run([str(kilter_binary()), *map(str, arguments)], capture_output=True, text=True, check=False, **user)
        except PermissionError:
            self.skipTest("another user cannot run the program where it lies")
        return Run(run.returncode, run.stdout, run.stderr)

    def test_a_replacement_that_is_refused_half_way_leaves_what_was_there(self):
        folder = self.write("half", "--set", "resolution=0.3")
        closed = folder / "b" / "submaps"
        self.addCleanup(closed.chmod, 0o755)
        for words in ("cannot be replaced", "cannot be written"):
            with self.subTest(words):
                closed.chmod(0o555)
                before = bytes_below(folder)
                run = self.run_as_anybody(folder, "submaps", self.tiny.mission, "-o", folder, "--replace", "--set",
                                          "submap_distance=20")
                self.assertTrue(bytes_below(folder) == before)
                self.assertEqual((run.status, run.stdout), (5, ""), run.stderr)
                self.assertIn(f"io: {closed}/000000.ot: {words}: Permission denied\n", run.stderr)
                self.assertEqual(sorted(path.name for path in folder.iterdir()), ["a", "b", "submaps.g2o"])
                # The second time there is nothing of b's to be replaced, and a's are in place when it fails.
                closed.chmod(0o755)
                for file in (folder / "b" / "poses.tum", *closed.iterdir()):
                    file.unlink(missing_ok=True)

    def test_robots_that_are_not_of_this_run_are_named(self):
        folder = self.tiny.folder / "fewer"
        rough = ("-o", folder, "--replace", "--set", "resolution=0.3")
        self.assertNotIn("not of this run", run_kilter("submaps", self.tiny.mission, *rough).stderr)
        before = bytes_below(folder / "b")
        alone = ("submaps", self.tiny.mission / "a", *rough)
        run = run_kilter(*alone)
        self.assertEqual(run.status, 0, run.stderr)
        self.assertIn(f"note: {folder} holds b too, which is not of this run and which `kilter check {folder}` reads with it\n",
                      run.stderr)
        self.assertIn(f"note: {folder}/submaps.g2o would lack what is not of this run, and is not there\n", run.stderr)
        self.assertEqual(sorted(path.name for path in folder.iterdir()), ["a", "b"], "a graph of a alone fits nothing")
        self.assertEqual(bytes_below(folder / "b"), before)
        self.assertEqual(run_kilter(*alone, "--quiet").stderr, "")
        self.assertEqual(run_kilter("submaps", self.tiny.mission, *rough).status, 0)
        graph = ("--submap-poses", folder / "submaps.g2o", "-o", self.tiny.folder / "graph")
        self.assertIn(run_kilter("check", folder, *graph).status, (0, 1, 4), "it fits what check reads")

    def test_a_pose_graph_of_others_stays(self):
        folder = self.tiny.folder / "graphs"
        graph = folder / "submaps.g2o"
        command = ("submaps", self.tiny.mission / "a", "-o", folder, "--set", "resolution=0.3")
        folder.mkdir()
        graph.write_text("VERTEX_SE3:QUAT 0 0 0 0 0 0 0 1\n")
        for options in ((), ("--replace",)):
            run = run_kilter(*command, *options)
            self.assertEqual((run.status, run.stdout), (2, ""), run.stderr)
            self.assertIn(f"usage: {graph}: a file of somebody else, in the place of the pose graph\n", run.stderr)
            self.assertEqual([path.name for path in folder.rglob("*")], ["submaps.g2o"])
        graph.unlink()
        self.assertEqual(run_kilter(*command).status, 0)
        alone = ("submaps", f"c={self.tiny.mission / 'b'}", "-o", folder, "--set", "resolution=0.3")
        run = run_kilter(*alone)
        self.assertEqual((run.status, run.stdout), (2, ""), run.stderr)
        self.assertIn(f"usage: {graph}: there is a pose graph already\n", run.stderr)
        self.assertEqual(run_kilter(*alone, "--replace").status, 0)
        self.assertEqual(sorted(path.name for path in folder.iterdir()), ["a", "c"])

    def test_a_robot_of_the_pose_graphs_name_is_refused_before_any_work(self):
        folder = self.tiny.folder / "namesake"
        run = run_kilter("submaps", f"submaps.g2o={self.tiny.mission / 'a'}", "-o", folder, "--verbose")
        self.assertEqual((run.status, run.stdout), (2, ""), run.stderr)
        self.assertRegex(run.stderr, "^usage: .*/submaps.g2o: the pose graph of all submaps gets that name")
        self.assertFalse(folder.exists())

    def test_the_folder_of_a_robot_is_none_for_submaps_of_others(self):
        before = sorted(self.tiny.mission.rglob("*"))
        run = run_kilter("submaps", self.tiny.mission, "-o", self.tiny.mission / "a", "--replace")
        self.assertEqual((run.status, run.stdout), (2, ""))
        self.assertIn(f"usage: -o {self.tiny.mission / 'a'}: this is a robot's own folder", run.stderr)
        self.assertEqual(sorted(self.tiny.mission.rglob("*")), before)

    def test_the_folder_of_the_scans_stays_theirs(self):
        scans = self.tiny.mission / "a" / "scans"
        before = sorted(self.tiny.mission.rglob("*"))
        run = run_kilter("submaps", self.tiny.mission, "-o", scans)
        self.assertEqual((run.status, run.stdout), (2, ""))
        self.assertIn(f"usage: -o {scans}: the clouds of robot a lie here", run.stderr)
        self.assertEqual(sorted(self.tiny.mission.rglob("*")), before)

    def test_submaps_are_not_written_over_those_that_are_read(self):
        folder = self.write("read")
        before = bytes_below(folder)
        for source in (folder, folder / "b"):
            run = run_kilter("submaps", source, "-o", folder, "--replace", "--set", "resolution=0.5")
            self.assertEqual((run.status, run.stdout), (2, ""))
            self.assertIn("submaps: the clouds of robot", run.stderr)
            self.assertEqual(bytes_below(folder), before)

    def test_folders_of_others_are_refused(self):
        run = run_kilter("submaps", self.tiny.mission, "-o", self.tiny.mission)
        self.assertEqual((run.status, run.stdout), (2, ""))
        self.assertIn("scans", run.stderr)
        folder = self.tiny.folder / "theirs"
        for name in ("a/poses.txt", "a/submaps/cloud.pcd"):
            (folder / name).parent.mkdir(parents=True, exist_ok=True)
            (folder / name).write_text("")
            run = run_kilter("submaps", self.tiny.mission, "-o", folder, "--replace")
            self.assertEqual((run.status, list(bytes_below(folder))), (2, [name]))
            (folder / name).unlink()

    def test_a_file_in_the_place_of_the_folder_is_an_output_error(self):
        file = self.tiny.folder / "file"
        file.write_text("")
        self.assertEqual(run_kilter("submaps", self.tiny.mission, "-o", file).status, 5)
        self.assertEqual(run_kilter("submaps", self.tiny.mission).status, 2)
        self.assertEqual(run_kilter("submaps", self.tiny.folder / "none", "-o", file).status, 3)

    def test_a_run_that_is_stopped_or_fails_leaves_what_was_there(self):
        earlier = self.write("earlier", "--set", "resolution=0.3")
        before = bytes_below(earlier)
        fresh = self.tiny.folder / "stopped"
        limit = lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (65536, 65536))  # noqa: E731
        fine = ("--set", "resolution=0.03", "--jobs", 1)  # so that it takes a while
        for folder in (earlier, fresh):
            run = interrupt_kilter(signal.SIGINT, "submaps", self.tiny.mission, "-o", folder, "--replace", *fine,
                                   after="submaps of b")
            self.assertEqual((run.status, run.stdout), (130, ""), run.stderr)
            self.assertRegex(run.stderr, r"(?m)^cancelled: ")
            full = subprocess.run([str(kilter_binary()), "submaps", str(self.tiny.mission), "-o", str(folder), "--replace"],
                                  capture_output=True, text=True, preexec_fn=limit, check=False)
            self.assertEqual((full.returncode, full.stdout), (5, ""), full.stderr)
            self.assertRegex(full.stderr, r"(?m)^no-space: " + re.escape(str(folder)) + "/[ab]/submaps/00000[0-9].ot: ")
        self.assertEqual(bytes_below(earlier), before)
        self.assertEqual(sorted(path.name for path in earlier.iterdir()), ["a", "b", "submaps.g2o"])
        self.assertFalse(fresh.exists())

    def test_a_lost_connection_stops_it_unless_it_was_started_to_outlive_that(self):
        folder = self.tiny.folder / "lost"
        fine = ("--set", "resolution=0.03", "--jobs", 1)
        # The shell that ends and the system both send one.
        run = interrupt_kilter(signal.SIGHUP, "submaps", self.tiny.mission, "-o", folder, *fine, after="submaps of b", times=2)
        self.assertEqual((run.status, run.stdout), (129, ""), run.stderr)
        self.assertRegex(run.stderr, r"(?m)^cancelled: ")
        self.assertFalse(folder.exists())
        run = interrupt_kilter(signal.SIGHUP, "submaps", self.tiny.mission, "-o", folder, "--jobs", 1, after="submaps of a",
                               ignored=(signal.SIGHUP,))
        self.assertEqual(run.status, 0, run.stderr)
        self.assertEqual(sorted(path.name for path in folder.iterdir()), ["a", "b", "submaps.g2o"])

    def test_nobody_who_reads_is_no_reason_to_die(self):
        folder = self.tiny.folder / "unread"
        command = [str(kilter_binary()), "submaps", str(self.tiny.mission), "-o", str(folder), "--verbose"]
        with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as run:
            run.stderr.readline()
            run.stderr.close()
            self.assertIn("`kilter check ", run.stdout.read())
        self.assertEqual(run.returncode, 0)
        self.assertEqual(sorted(path.name for path in folder.iterdir()), ["a", "b", "submaps.g2o"])


class Trees(unittest.TestCase):
    def test_single_trees_are_compared(self):
        with TinyMission() as tiny:
            run_kilter("submaps", tiny.mission, "-o", tiny.folder / "trees", "--set", "submap_distance=100")
            tree = tiny.folder / "trees" / "a" / "submaps" / "000000.ot"
            run = run_kilter("check", f"a={tree}", f"b={tree}", "-o", tiny.folder / "out")
            self.assertEqual(run.status, 0, run.stdout + run.stderr)
            self.assertIn("OctoMap tree, 1 submap, 1 robot", run.stdout)
            self.assertEqual(run_kilter("info", tree).status, 0)
            coarse = run_kilter("check", f"a={tree}", f"b={tree}", "-o", tiny.folder / "out", "--set", "resolution=0.2")
            self.assertIn("--set resolution=0.1", coarse.stderr)

    def test_hostile_trees_end_with_status_3_and_the_file(self):
        with TinyMission() as tiny:
            head = "# Octomap OcTree {}file\nid OcTree\nsize {}\nres {}\ndata\n"
            bombs = {
                "deep.bt": head.format("binary ", 400001, 0.1).encode() + b"\xff" * 200_000,
                "deep.ot": head.format("", 400000, 0.1).encode() + b"\xff" * 2_000_000,
                "short.bt": head.format("binary ", 6, 0.1).encode() + b"\xc9",
                "size.ot": head.format("", 10**18, 0.1).encode() + b"\0" * 5,
                "zero.ot": head.format("", 1, 0).encode() + b"\0" * 5,
                "nan.ot": head.format("", 1, "nan").encode() + b"\0" * 5,
                "class.ot": head.format("", 1, 0.1).replace("id OcTree", "id SemanticOcTree").encode() + b"\0" * 5,
                "all.ot": head.format("", 1, 0.1).encode() + struct.pack("<fB", -2.0, 0),
                "old.bt": struct.pack("<idI", 3, 0.1, 6) + b"\xc9\x80\x10\x00",
                "empty.ot": b"",
            }
            for name, content in bombs.items():
                with self.subTest(name):
                    file = tiny.folder / name
                    file.write_bytes(content)
                    run = run_kilter("check", file, "-o", tiny.folder / "none")
                    self.assertEqual((run.status, run.stdout), (3, ""), run.stderr)
                    self.assertIn(name, run.stderr)
                    self.assertFalse((tiny.folder / "none").exists())


if __name__ == "__main__":
    main()
