# SPDX-FileCopyrightText: The kilter authors
# SPDX-License-Identifier: BSD-3-Clause
"""`kilter check` from outside: verdicts and statuses, the files it leaves, and that it keeps what it promises of them."""

from __future__ import annotations

import contextlib
import csv
import json
import math
import os
import pty
import re
import shutil
import signal
import struct
import subprocess
import unittest
from pathlib import Path

import jsonschema
from kilter_runner import SOURCE_DIR, interrupt_kilter, kilter_binary, main, run_kilter
from tiny_mission import TinyMission, read_result

FILES = {"result.json", "pairs.csv", "gamma.csv", "theta.csv", "verified.csv", "constraints.g2o", "report.html",
         "result.kilter", "gamma.png", "theta.png", "verified.png", "map.png", "coloured.ply"}
SCHEMA = json.loads((SOURCE_DIR / "docs" / "result.schema.json").read_text(encoding="utf-8"))


def without_run(result: dict) -> dict:
    return {key: value for key, value in result.items() if key != "run"}


class CheckCase(unittest.TestCase):
    """One mission for all tests of a class; each test has an output folder of its own."""

    # Twice the default is as good where the numbers do not matter, and much quicker.
    settings = ("--set", "resolution=0.2")

    @classmethod
    def setUpClass(cls) -> None:
        cls.tiny = cls.enterClassContext(TinyMission())

    def setUp(self) -> None:
        self.out = self.tiny.folder / f"out-{self.id().rsplit('.', 1)[-1]}"

    def check(self, *arguments: object, **keywords: object):
        return run_kilter("check", self.tiny.mission, "-o", self.out, *self.settings, *arguments, **keywords)


class Verdicts(CheckCase):
    settings = ()

    def test_the_planted_fault_is_found(self):
        run = self.check()
        self.assertEqual(run.status, 1, run.stderr)
        self.assertTrue(run.stdout.startswith("INCONSISTENT: "), run.stdout)
        self.assertRegex(run.stdout, r"p inconsistent\n! b/1 <- b/2 +sequential +40 cm ", "where it happened comes first")
        result = read_result(self.out)
        self.assertEqual(result["system"]["verdict"], "inconsistent")
        pair = next(p for p in result["pairs"] if (p["target"], p["source"]) == ("b/1", "b/2"))
        self.assertEqual(pair["verdict"], "inconsistent")
        self.assertAlmostEqual(pair["offset_m"], 0.4, delta=0.03)

    def test_the_same_scans_where_they_belong_are_consistent(self):
        run = self.check("--poses", self.tiny.truth)
        self.assertEqual(run.status, 0, run.stdout + run.stderr)
        self.assertTrue(run.stdout.startswith("CONSISTENT: "), run.stdout)
        self.assertIs(read_result(self.out)["system"]["consistent"], True)

    def test_robots_that_never_meet_are_undetermined(self):
        run = self.check("--poses", self.tiny.apart)
        self.assertEqual(run.status, 4, run.stdout + run.stderr)
        self.assertTrue(run.stdout.startswith("UNDETERMINED: "), run.stdout)
        self.assertRegex(run.stdout, r"\nNever meet +a and b\n")
        self.assertEqual(read_result(self.out)["system"]["decided"]["global"], {"a,b": None})

    def test_one_scan_alone_is_undetermined(self):
        run = run_kilter("check", self.tiny.copy("one", scans=1), "-o", self.out)
        self.assertEqual(run.status, 4, run.stderr)
        self.assertEqual(read_result(self.out)["pairs"], [])

    def test_a_larger_tolerance_lets_the_fault_pass(self):
        run = self.check("--set", "tolerance=0.8")
        self.assertEqual(run.status, 0, run.stdout)
        self.assertEqual(read_result(self.out)["config"]["tolerance"], 0.8)

    def test_the_seed_preset_runs_the_papers_registration(self):
        run = self.check("--preset", "seed", "--set", "alpha=0.05", "--set", "registration_wide=3")
        self.assertIn(run.status, (0, 1, 4), run.stderr)
        self.assertIn("OICP: registration_wide has no effect\n", run.stderr)
        self.assertIn("other pairs: alpha has no effect on verdicts\n", run.stderr)
        result = read_result(self.out)
        self.assertEqual(result["config"]["registration"], "oicp")
        self.assertEqual(result["config"]["floor"], "none")
        self.assertTrue(any(pair["theta_oicp"] is not None for pair in result["pairs"]))

    def test_keys_come_from_a_file_and_the_command_line_wins(self):
        config = self.tiny.folder / "keys.toml"
        config.write_text('tolerance = "7 cm"\nmatched_min = 300\nfit = "mle"\n')
        self.check("--config", config, "--set", "matched_min=250")
        keys = read_result(self.out)["config"]
        self.assertEqual((keys["tolerance"], keys["matched_min"], keys["fit"]), (0.07, 250, "mle"))


class Files(CheckCase):
    """What one run left, looked at from all sides."""

    @classmethod
    def setUpClass(cls) -> None:
        super().setUpClass()
        cls.out = cls.tiny.folder / "out"
        run_kilter("check", cls.tiny.mission, "-o", cls.out, *cls.settings)
        cls.result = read_result(cls.out)

    def setUp(self) -> None:
        """The folder of the class stays."""

    def test_every_promised_file_is_there_and_nothing_else(self):
        self.assertEqual({path.name for path in self.out.iterdir()}, FILES)

    def test_nothing_but_the_run_tells_where_the_mission_lay(self):
        self.assertNotIn(str(self.tiny.folder), json.dumps(without_run(self.result)))
        for name in FILES - {"result.json"}:
            self.assertNotIn(str(self.tiny.folder).encode(), (self.out / name).read_bytes(), name)

    def test_matrices_agree_with_the_result(self):
        ids = [submap["id"] for submap in self.result["submaps"]]
        for key in ("gamma", "theta", "verified"):
            with open(self.out / f"{key}.csv", newline="", encoding="utf-8") as file:
                header, *rows = csv.reader(file)
            self.assertEqual(header[1:], ids)
            self.assertEqual([row[0] for row in rows], ids)
            cells = {(target, row[0]): float(cell)
                     for row in rows for target, cell in zip(ids, row[1:], strict=True) if cell}
            pairs = {(pair["target"], pair["source"]): pair[key] for pair in self.result["pairs"] if pair[key] is not None}
            self.assertEqual(cells, pairs)

    def test_pairs_csv_has_a_column_for_every_piece_of_evidence_in_the_documents(self):
        with open(self.out / "pairs.csv", newline="", encoding="utf-8") as file:
            columns = next(csv.reader(file))
        text = (SOURCE_DIR / "docs" / "verdicts.md").read_text(encoding="utf-8").split("## Evidence of a pair")[1]
        named = re.findall(r"^\| `(\w+)` \|", text.split("\n## ")[0], re.MULTILINE)
        self.assertEqual([c for c in columns if c.startswith("evidence_") and not c.endswith("_log_ratio")],
                         [f"evidence_{name}" for name in sorted(named)])
        self.assertLessEqual(set().union(*(pair["evidence"] for pair in read_result(self.out)["pairs"])), set(named))

    def test_pairs_csv_has_a_row_for_every_pair(self):
        with open(self.out / "pairs.csv", newline="", encoding="utf-8") as file:
            rows = list(csv.DictReader(file))
        pairs = self.result["pairs"]
        self.assertEqual([(row["target"], row["source"], row["verdict"], row["reason"]) for row in rows],
                         [(pair["target"], pair["source"], pair["verdict"], pair["reason"]) for pair in pairs])

    def test_constraints_hold_every_submap_and_each_trusted_edge(self):
        rows = [line.split() for line in (self.out / "constraints.g2o").read_text().splitlines() if line[0] != "#"]
        vertices = [row for row in rows if row[0] == "VERTEX_SE3:QUAT"]
        self.assertEqual([int(row[1]) for row in vertices], list(range(len(self.result["submaps"]))))
        for row, submap in zip(vertices, self.result["submaps"], strict=True):
            self.assertEqual([float(word) for word in row[2:]], submap["T_world_submap"])
        number = {submap["id"]: i for i, submap in enumerate(self.result["submaps"])}
        poses = {(number[pair["target"]], number[pair["source"]]): pair["T_target_source_registered"]
                 for pair in self.result["pairs"] if pair["verdict"] != "unverified"}
        edges = {(int(row[1]), int(row[2])): [float(word) for word in row[3:10]]
                 for row in rows if row[0] == "EDGE_SE3:QUAT"}
        self.assertEqual(edges, poses)


class Output(CheckCase):
    def test_fail_on_chooses_which_verdicts_fail(self):
        for poses, fail_on, status in (("mission", "inconsistent", 1), ("mission", "undetermined", 1),
                                       ("mission", "never", 0), ("apart", "inconsistent", 0),
                                       ("apart", "undetermined", 4), ("apart", "never", 0)):
            with self.subTest(poses=poses, fail_on=fail_on):
                run = self.check("--poses", self.tiny.folder / poses, "--fail-on", fail_on)
                self.assertEqual(run.status, status, run.stdout)

    def test_the_result_follows_its_schema(self):
        for poses in (self.tiny.mission, self.tiny.truth, self.tiny.apart):
            self.check("--poses", poses)
            jsonschema.Draft202012Validator(SCHEMA).validate(read_result(self.out))

    def test_json_goes_to_standard_output_and_nothing_else_does(self):
        run = self.check("--json", "--verbose")
        self.assertEqual(run.stdout, (self.out / "result.json").read_text(encoding="utf-8"))
        self.assertEqual(json.loads(run.stdout)["schema"], "kilter.result/1")
        self.assertIn("pairs", run.stderr)
        self.assertEqual(sum(line.startswith("picture: ") for line in run.stderr.splitlines()), 2, run.stderr)

    def test_quiet_leaves_standard_error_empty(self):
        self.assertEqual(self.check("--quiet").stderr, "")

    def test_a_tolerance_that_voxels_do_not_tell_is_noted(self):
        below = "note: tolerance = 0.001 m is below what voxels of 0.2 m tell"
        self.assertIn(below, self.check("--set", "tolerance=1 mm", "--set", "resolution=0.2").stderr)
        self.assertNotIn("below what voxels", self.check("--set", "tolerance=0.02", "--set", "resolution=0.2").stderr)

    def test_more_jobs_than_processors_are_nothing_to_talk_about(self):
        allowed = os.sched_getaffinity(0)
        self.addCleanup(os.sched_setaffinity, 0, allowed)
        os.sched_setaffinity(0, {min(allowed)})
        self.assertEqual(self.check("--quiet", "--jobs", 3).stderr, "")

    def test_any_number_of_jobs_and_any_memory_give_the_same_bytes(self):
        one, two = self.out / "one", self.out / "two"
        run_kilter("check", self.tiny.mission, "-o", one, "--jobs", 1, "--maps", *self.settings)
        # Searches take about half as much as a map: room for little more than a pair, so that the others wait on disk.
        enough = 4 * max(submap["bytes"] for submap in read_result(one)["submaps"])
        run = run_kilter("check", self.tiny.mission, "-o", two, "--jobs", 2, "--memory", enough, "--maps",
                         *self.settings)
        self.assertNotEqual(run.status, 5, run.stderr)
        names = sorted(str(path.relative_to(one)) for path in one.rglob("*") if path.is_file())
        self.assertEqual(names, sorted([*FILES, *(f"maps/{name}.{kind}" for name in ("a", "b", "global") for kind in ("ot", "ply"))]))
        for name in names:
            if name != "result.json":
                self.assertEqual((one / name).read_bytes(), (two / name).read_bytes(), name)
        results = [read_result(folder) for folder in (one, two)]
        self.assertEqual([result["run"]["jobs"] for result in results], [1, 2])
        self.assertEqual(*(json.dumps(without_run(result)) for result in results))

    def test_maps_are_point_clouds_that_hold_what_they_say(self):
        self.check("--maps")
        for name in ("a", "b", "global"):
            header, body = (self.out / "maps" / f"{name}.ply").read_bytes().split(b"end_header\n", 1)
            count = int(next(line.split()[2] for line in header.splitlines() if line.startswith(b"element vertex")))
            self.assertGreater(count, 1000)
            self.assertEqual(len(body), count * struct.calcsize("<3d3Bf"))

    def test_cuts_of_another_result_are_used_again(self):
        self.check("--set", "submap_distance=6")
        before = read_result(self.out)
        again = self.out.with_name("again")
        run_kilter("check", self.tiny.mission, "--poses", self.tiny.truth, "--cuts", self.out, "-o", again,
                   *self.settings)
        after = read_result(again)
        keys = ("id", "first_scan", "last_scan")
        self.assertEqual(*([[submap[key] for key in keys] for submap in result["submaps"]] for result in (before, after)))
        self.assertEqual(after["run"]["cuts"], str(self.out))
        self.assertGreater(len(after["submaps"]), 6)
        self.assertEqual(after["config"]["submap_distance"], 6)
        self.assertEqual(after["config_digest"], before["config_digest"])
        run = run_kilter("check", self.tiny.mission, "--poses", self.tiny.truth, "--cuts", self.out, "-o", again,
                         *self.settings, "--set", "submap_distance=3")
        self.assertIn(f"note: submaps are cut as {self.out} has them: submap_distance has no effect\n", run.stderr)
        self.assertEqual(read_result(again)["config_digest"], before["config_digest"])

    def test_cuts_of_other_robots_are_refused_and_of_some_are_told(self):
        self.check()
        renamed = [f"{name}={self.tiny.mission / robot}" for name, robot in (("c", "a"), ("d", "b"))]
        sets = "cuts for a, b, and none for the robots that there are: c, d"
        for command, out in (("check", self.out.with_name("none")), ("submaps", self.out.with_name("no-submaps"))):
            run = run_kilter(command, *renamed, "--cuts", self.out, "-o", out, *self.settings)
            self.assertEqual((run.status, run.stdout), (3, ""), run.stderr)
            self.assertTrue(run.stderr.startswith(f"count-mismatch: {self.out}: {sets}\n  try: "), run.stderr)
            self.assertFalse(out.exists())
            some = (command, f"a={self.tiny.mission / 'a'}", renamed[1], "--cuts", self.out, "-o", out, *self.settings)
            run = run_kilter(*some)
            self.assertIn(run.status, (0, 1, 4), run.stderr)
            self.assertIn(f"note: {self.out} has no cuts for d, cut anew\n", run.stderr)
            self.assertEqual(run_kilter(*some, "--quiet", *(["--replace"] if command == "submaps" else [])).stderr, "")

    def test_what_makes_nonsense_of_a_map_is_told_before_and_after(self):
        scaled = self.out.with_name("scaled")
        shutil.copytree(self.tiny.mission / "a", scaled / "a")
        poses = scaled / "a" / "poses.tum"
        rows = [line.split() for line in poses.read_text(encoding="utf-8").splitlines() if not line.startswith("#")]
        poses.write_text("".join(" ".join([row[0], *(str(1000 * float(x)) for x in row[1:4]), *row[4:]]) + "\n"
                                 for row in rows), encoding="utf-8")
        run = run_kilter("check", scaled, "-o", self.out, *self.settings)
        self.assertIn("which is odd (millimetres): write clouds and poses in metres", run.stderr)
        self.assertIn("\nNext        see to the input first (millimetres of robot a)", run.stdout)
        self.assertNotIn("odd", self.check().stderr)

    def test_a_mounting_that_was_left_out_is_named_with_its_quaternion(self):
        made = self.out.with_name("office")
        run_kilter("simulate", "office", "-o", made, "--scale", "0.5", "--columns", "360", "--fault", "none", "--quiet")
        turned = made / "mission"
        half = math.sqrt(0.5)
        for poses in turned.glob("*/poses.tum"):
            rows = [line.split() for line in poses.read_text(encoding="utf-8").splitlines() if not line.startswith("#")]
            with poses.open("w", encoding="utf-8") as file:
                for stamp, *place, x, y, z, w in rows:
                    qx, qy, qz, qw = (float(word) for word in (x, y, z, w))
                    print(stamp, *place, half * (qx - qy), half * (qx + qy), half * (qz - qw), half * (qw + qz), file=file)
        told = json.loads(run_kilter("info", turned, "--json").stdout)["oddities"]
        self.assertEqual([(oddity["robot"], oddity["code"]) for oddity in told], [("a", "turned-sensor"), ("b", "turned-sensor")])
        self.assertIn("turned by 90 degrees about z (qx qy qz qw: 0.000 0.000 0.707 0.707)", told[0]["found"])
        run = run_kilter("check", turned, "-o", self.out, "--set", "resolution=0.4")
        self.assertIn("\nNext        see to the input first (turned-sensor of robot a)", run.stdout)
        given = run_kilter("info", turned, "--json", "--set", "T_body_sensor=0 0 0 0 0 0.70710678 0.70710678")
        self.assertEqual(json.loads(given.stdout)["oddities"], [])

    def test_one_robot_under_two_names_is_told(self):
        twice = [f"{name}={self.tiny.mission / 'a'}" for name in ("c", "d")]
        run = run_kilter("check", *twice, "-o", self.out, *self.settings)
        self.assertIn("note: robot d: its poses and clouds are those of c; ", run.stderr)
        self.assertNotIn("those of", self.check().stderr)


class Terminal(CheckCase):
    def on_a_terminal(self, *arguments: str, **environment: str) -> str:
        """What a terminal shows of a run, standard output and error together."""
        command = [str(kilter_binary()), "check", str(self.tiny.mission), "-o", str(self.out), *self.settings, *arguments]
        kept = {key: value for key, value in os.environ.items() if key != "NO_COLOR"}
        try:
            ours, theirs = pty.openpty()
        except OSError as error:  # a container or chroot without /dev/pts
            self.skipTest(f"no terminal to be had: {error}")
        with subprocess.Popen(command, stdin=theirs, stdout=theirs, stderr=theirs,
                              env={**kept, "TERM": "xterm", **environment}):
            os.close(theirs)
            shown = b""
            with contextlib.suppress(OSError):  # how Linux says that the other side is closed
                while piece := os.read(ours, 4096):
                    shown += piece
            os.close(ours)
        return shown.decode()

    def test_the_verdict_is_coloured_and_a_bar_is_drawn_and_taken_away(self):
        shown = self.on_a_terminal()
        self.assertIn("\x1b[1;31mINCONSISTENT\x1b[0m: ", shown)
        self.assertRegex(shown, r"\r\x1b\[Kpairs +\[#* *\] +\d+ %")
        self.assertRegex(shown, r"\r\x1b\[K\x1b\[1;31mINCONSISTENT")

    def test_no_colour_when_it_is_not_wanted(self):
        for arguments, environment in ((("--no-color",), {}), ((), {"NO_COLOR": "1"}), ((), {"TERM": "dumb"})):
            self.assertNotIn("\x1b[1;31m", self.on_a_terminal(*arguments, **environment))


class Trouble(CheckCase):
    def interrupted(self, number: signal.Signals) -> tuple[int, str]:
        """Status and messages of a run that gets a signal once it has begun to work."""
        run = interrupt_kilter(number, "check", self.tiny.mission, "-o", self.out, "--jobs", "1", "--set", "resolution=0.02")
        self.assertEqual(run.stdout, "")
        return run.status, run.stderr

    def test_ctrl_c_ends_it_with_130_and_nothing_is_written(self):
        status, messages = self.interrupted(signal.SIGINT)
        self.assertEqual(status, 130, messages)
        self.assertIn("\ncancelled: ", messages)
        self.assertFalse(self.out.exists())

    def test_a_polite_kill_ends_it_with_143_and_nothing_is_written(self):
        status, messages = self.interrupted(signal.SIGTERM)
        self.assertEqual(status, 143, messages)
        self.assertFalse(self.out.exists())

    def test_no_place_for_what_memory_leaves_out_is_said_and_ends_with_5(self):
        run = self.check("--memory", "2M", environment={"TMPDIR": "/no/such/folder"})
        self.assertEqual(run.status, 5, run.stderr)
        self.assertRegex(run.stderr, r"(?m)^out-of-memory: /no/such/folder: submaps that --memory leaves no room for: ")
        self.assertFalse(self.out.exists())

    def test_a_budget_that_does_not_do_is_said_and_ends_with_5(self):
        run = self.check("--memory", "10K")
        self.assertEqual(run.status, 5)
        self.assertRegex(run.stderr, r"(?m)^out-of-memory: ")
        self.assertFalse(self.out.exists())

    def test_a_closed_standard_error_changes_nothing(self):
        command = ["sh", "-c", 'exec "$0" "$@" 2>&-', str(kilter_binary()), "check", str(self.tiny.mission), "-o",
                   str(self.out), "--verbose", *self.settings]
        run = subprocess.run(command, stdout=subprocess.PIPE, text=True, check=False)
        self.assertEqual(run.returncode, 1)
        self.assertTrue(run.stdout.startswith("INCONSISTENT"))
        # What memory leaves out must not become the file that messages go to.
        enough = 4 * max(submap["bytes"] for submap in read_result(self.out)["submaps"])
        run = subprocess.run([*command, "--memory", str(enough)], stdout=subprocess.PIPE, text=True, check=False)
        self.assertEqual(run.returncode, 1)
        self.assertTrue(run.stdout.startswith("INCONSISTENT"))
        run = subprocess.run([*command[:5], "no/such/mission"], stdout=subprocess.PIPE, text=True, check=False)
        self.assertEqual((run.returncode, run.stdout), (3, ""))

    def test_an_output_folder_without_a_name_is_refused(self):
        run = run_kilter("check", self.tiny.mission, "-o", "")
        self.assertEqual((run.status, run.stdout), (2, ""))
        self.assertTrue(run.stderr.startswith('usage: --output: expected a name, found ""\n'), run.stderr)

    @unittest.skipIf(not os.path.exists("/dev/full"), "there is no /dev/full here")
    def test_a_standard_output_that_takes_nothing_ends_with_5(self):
        with open("/dev/full", "w", encoding="ascii") as full:
            command = [str(kilter_binary()), "check", str(self.tiny.mission), "-o", str(self.out)]
            run = subprocess.run(command, stdout=full, stderr=subprocess.PIPE, text=True, check=False)
        self.assertEqual(run.returncode, 5)
        self.assertRegex(run.stderr, r"(?m)^no-space: standard output: ")


if __name__ == "__main__":
    main()
