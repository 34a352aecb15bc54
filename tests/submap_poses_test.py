# SPDX-FileCopyrightText: The kilter authors
# SPDX-License-Identifier: BSD-3-Clause
"""`--submap-poses`: what an optimiser makes of constraints.g2o goes back into check."""

from __future__ import annotations

import unittest
from pathlib import Path

from kilter_runner import main, run_kilter
from tiny_mission import TinyMission, read_result

SETTINGS = ("--set", "resolution=0.2")


def pose_of(submap: dict) -> list[float]:
    return submap["T_world_submap"]


def graph_of(poses: list[list[float]]) -> str:
    return "".join(f"VERTEX_SE3:QUAT {i} {' '.join(map(repr, pose))}\n" for i, pose in enumerate(poses))


class SubmapPoses(unittest.TestCase):
    @classmethod
    def setUpClass(cls) -> None:
        cls.tiny = cls.enterClassContext(TinyMission())
        cls.out = cls.tiny.folder / "first"
        run_kilter("check", cls.tiny.mission, "-o", cls.out, *SETTINGS)
        cls.first = read_result(cls.out)

    def again(self, graph: str, *arguments: object, source: object = None, command: str = "check"):
        file = self.tiny.folder / f"{self.id().rsplit('.', 1)[-1]}.g2o"
        file.write_text(graph, encoding="utf-8")
        out = file.with_suffix(f".{command}")
        run = run_kilter(command, source or self.tiny.mission, "--submap-poses", file, "-o", out, *SETTINGS, *arguments)
        return run, out

    def test_the_graph_that_check_wrote_changes_nothing(self):
        run, out = self.again((self.out / "constraints.g2o").read_text(encoding="utf-8"), "--cuts", self.out)
        self.assertEqual(run.status, 1, run.stderr)
        result = read_result(out)
        self.assertTrue(result["run"]["submap_poses"].endswith(".g2o"))
        for before, after in zip(self.first["submaps"], result["submaps"], strict=True):
            for a, b in zip(pose_of(before), pose_of(after), strict=True):
                self.assertAlmostEqual(a, b, places=6)
        self.assertEqual(*([p["verdict"] for p in r["pairs"]] for r in (self.first, result)))
        self.assertIn(".g2o: submaps moved by 0.00 to 0.00 m (median 0.00 m), 0.0 to 0.0 deg\n", run.stderr)

    def test_a_graph_of_another_map_is_told_by_its_names_and_its_distance(self):
        graph = (self.out / "constraints.g2o").read_text(encoding="utf-8")
        run, out = self.again(graph.replace("# a/2\n", "# b/2\n"), "--cuts", self.out)
        self.assertEqual((run.status, run.stdout, out.exists()), (3, "", False), run.stderr)
        self.assertIn("vertex 1 is called b/2, but that submap here is a/2", run.stderr)
        poses = [[x + 6.0, *rest] for x, *rest in (pose_of(submap) for submap in self.first["submaps"])]
        run, _ = self.again(graph_of(poses), "--cuts", self.out, command="submaps")
        self.assertIn("submaps moved by 6.00 to 6.00 m (median 6.00 m), 0.0 to 0.0 deg; so far as that", run.stderr)

    def test_where_each_submap_belongs_makes_the_map_consistent(self):
        truth = self.tiny.folder / "at-truth"
        run_kilter("check", self.tiny.mission, "--poses", self.tiny.truth, "--cuts", self.out, "-o", truth, *SETTINGS)
        right = read_result(truth)
        run, out = self.again(graph_of([pose_of(submap) for submap in right["submaps"]]), "--cuts", self.out)
        found = [p for p in read_result(out)["pairs"] if p["verdict"] == "inconsistent"]
        self.assertEqual(found, [], run.stdout)
        self.assertNotIn("--poses", run.stderr)
        mended, _ = self.again(graph_of([pose_of(submap) for submap in right["submaps"]]), "--cuts", truth)
        self.assertIn(f"{truth} was made with --poses {self.tiny.truth}, and this is not", mended.stderr)
        self.assertGreater(self.first["system"]["inconsistent"], 0)

    def test_a_vertex_moves_its_submap_and_no_other(self):
        poses = [list(pose_of(submap)) for submap in self.first["submaps"]]
        poses[1][2] += 1.0
        _, out = self.again(graph_of(poses), "--cuts", self.out)
        for i, (pose, submap) in enumerate(zip(poses, read_result(out)["submaps"], strict=True)):
            self.assertAlmostEqual(pose_of(submap)[2], pose[2], places=6, msg=str(i))

    def test_submaps_are_written_where_it_has_them_and_need_no_cuts_then(self):
        poses = [list(pose_of(submap)) for submap in self.first["submaps"]]
        for pose in poses:
            pose[0] += 5.0
        run, maps = self.again(graph_of(poses), "--cuts", self.out, command="submaps")
        self.assertEqual(run.status, 0, run.stderr)
        first = next(line for line in (maps / "submaps.g2o").read_text(encoding="utf-8").splitlines()
                     if line.startswith("VERTEX_SE3:QUAT 0 "))
        self.assertAlmostEqual(float(first.split()[2]), poses[0][0], places=6)
        for pose in poses:
            pose[0] -= 5.0
        run, out = self.again(graph_of(poses), "--cuts", self.out, source=maps)
        self.assertIn("note: finished submaps are not cut: --cuts has no effect on them\n", run.stderr)
        self.assertAlmostEqual(pose_of(read_result(out)["submaps"][0])[0], poses[0][0], places=6)

    def test_what_does_not_fit_is_refused_before_any_work(self):
        poses = [pose_of(submap) for submap in self.first["submaps"]]
        for graph, arguments, part in ((graph_of(poses[:-1]), ("--cuts", self.out), "vertices, the last with id"),
                                       (graph_of(poses), (), "where robot a was cut into them is not known"),
                                       ("nonsense\n", ("--cuts", self.out), ".g2o")):
            run, out = self.again(graph, *arguments)
            self.assertEqual((run.status, run.stdout), (3, ""), run.stderr)
            self.assertIn(part, run.stderr)
            self.assertFalse(Path(out).exists())


if __name__ == "__main__":
    main()
