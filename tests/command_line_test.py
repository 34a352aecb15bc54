# SPDX-FileCopyrightText: The kilter authors
# SPDX-License-Identifier: BSD-3-Clause
"""Everything about the command line but `check` itself: help, version, keys, explanations, what a mission holds."""

from __future__ import annotations

import json
import os
import re
import subprocess
import tempfile
import time
import tomllib
import unittest
from pathlib import Path

from kilter_runner import SOURCE_DIR, kilter_binary, main, run_kilter
from tiny_mission import TinyMission


def source(path: str) -> str:
    return (SOURCE_DIR / path).read_text()


COMMANDS = ("check", "info", "simulate", "submaps", "config show", "explain")
COMMON = ("--config", "--set", "--jobs", "--memory", "--quiet", "--verbose", "--json", "--no-color")
# Keys that scripts rely on, with their defaults.
KEYS = {"resolution": 0.1, "submap_distance": 10, "local_min_gap": 2, "d": 1.0, "fit": "moments", "floor": "quantisation",
        "registration": "point_to_plane", "tolerance": 0.1, "alpha": 0.01, "prior_inconsistent": 0.05, "min_decided": 0.5}


class Help(unittest.TestCase):
    def test_help_lists_every_command_and_takes_no_time(self):
        best_s = 10.0
        for _ in range(5):
            start = time.monotonic()
            run = run_kilter("--help")
            best_s = min(best_s, time.monotonic() - start)
        self.assertEqual((run.status, run.stderr), (0, ""))
        for command in COMMANDS:
            self.assertRegex(run.stdout, rf"\n  {command.split()[0]} ")
        self.assertLess(best_s, 0.2)

    def test_each_command_explains_its_options(self):
        for command in COMMANDS:
            run = run_kilter(*command.split(), "--help")
            self.assertEqual((run.status, run.stderr), (0, ""))
            for option in COMMON:
                self.assertIn(option, run.stdout, command)

    def test_options_that_must_be_there_are_marked(self):
        for command in ("report", "simulate", "submaps"):
            self.assertRegex(run_kilter(command, "--help").stdout, r"(?m)^ +-o,--output \S+ REQUIRED\s")

    def test_commands_of_config_are_told_like_others(self):
        self.assertIn('usage: there is no command "kilter config shwo"\n', run_kilter("config", "shwo").stderr)
        self.assertIn("usage: kilter config expects a command of its own\n", run_kilter("config").stderr)

    def test_the_version_is_the_projects(self):
        cmake = (SOURCE_DIR / "CMakeLists.txt").read_text(encoding="utf-8")
        version = re.search(r"VERSION (\d+\.\d+\.\d+)", cmake)[1]
        self.assertEqual(run_kilter("--version").stdout, f"kilter {version}\n")

    def test_what_was_meant_is_offered(self):
        for arguments, part in ((("chekc",), "kilter check"), (("check", "x", "--quite"), "--quiet"),
                                (("explain", "parze"), "kilter explain parse"), (("explain", "tolerance"), "kilter config show"),
                                (("config",), "kilter config --help"),
                                (("config", "shwo"), "kilter config --help"),
                                ((), "kilter --help")):
            run = run_kilter(*arguments)
            self.assertEqual((run.status, run.stdout), (2, ""), run.stderr)
            self.assertRegex(run.stderr, rf"^usage: .*\n  try: {re.escape(part)}\n$")

    def test_options_before_the_command_are_sent_behind_it(self):
        for arguments, option, hint in ((("-o", "out", "check", "x"), "-o", "kilter check ... -o"),
                                        (("--quiet", "info", "x"), "--quiet", "kilter info ... --quiet")):
            run = run_kilter(*arguments)
            self.assertEqual((run.status, run.stdout), (2, ""))
            self.assertRegex(run.stderr, rf'^usage: "{option}" stands before the command, .*\n  try: {re.escape(hint)}\n$')

    def test_words_are_listed_where_another_or_a_number_is_given(self):
        for command, option, words in (("check x", "--fail-on", "inconsistent, undetermined or never"),
                                       ("check x", "--g2o-dialect", "g2o, gtsam or ceres"),
                                       ("check x", "--preset", "seed"), ("config show", "--preset", "seed"),
                                       ("submaps x -o y", "--format", "ot, bt, pcd or ply"),
                                       ("simulate office -o y", "--format", "bin or pcd")):
            for value in ("maybe", "0", "2", ""):
                with self.subTest(option=option, value=value):
                    run = run_kilter(*command.split(), option, value)
                    self.assertEqual((run.status, run.stdout), (2, ""))
                    self.assertRegex(run.stderr, rf'^usage: {option}: expected {words}, found "{value}"\n  try: kilter ')

    def test_what_is_no_number_of_threads_is_told_in_words(self):
        for value in ("two", "2.5", "0", "1025", "-1", ""):
            run = run_kilter("check", "x", "--jobs", value)
            self.assertEqual((run.status, run.stdout), (2, ""))
            self.assertIn(f'--jobs: expected a whole number from 1 to 1024, found "{value}"\n', run.stderr)

    def test_an_option_without_its_value_or_given_twice_is_told_in_words(self):
        for arguments, words in ((("check", "x", "-o"), "--output: expected a value, found none"),
                                 (("check", "x", "-o", "a", "-o", "b"), "--output: expected once, found 2 times"),
                                 (("check", "x", "--preset"), "--preset: expected a value, found none"),
                                 (("check", "x", "--jobs", "1", "--jobs", "2"), "--jobs: expected once, found 2 times")):
            run = run_kilter(*arguments)
            self.assertEqual((run.status, run.stdout), (2, ""))
            self.assertEqual(run.stderr, f"usage: {words}\n  try: kilter check --help\n")

    def test_the_manual_tells_every_command_and_option(self):
        manual = (SOURCE_DIR / "docs" / "cli.md").read_text(encoding="utf-8")
        for command in COMMANDS:
            self.assertIn(f"kilter {command}", manual)
            for option in re.findall(r"--[a-z][a-z-]+", run_kilter(*command.split(), "--help").stdout):
                self.assertIn(option, manual)


class StandardOutput(unittest.TestCase):
    @unittest.skipIf(not os.path.exists("/dev/full"), "there is no /dev/full here")
    def test_one_that_takes_nothing_is_an_error_of_help_and_version_too(self):
        for arguments in (("--help",), ("--version",), ("check", "--help"), ("config", "show", "--help"), ("explain",)):
            with self.subTest(arguments=arguments), open("/dev/full", "w", encoding="ascii") as full:
                run = subprocess.run([str(kilter_binary()), *arguments], stdout=full, stderr=subprocess.PIPE, text=True,
                                     check=False)
                self.assertEqual(run.returncode, 5)
                self.assertTrue(run.stderr.startswith("no-space: standard output: cannot be written: "), run.stderr)

    def test_one_that_nobody_reads_any_more_is_an_error_like_others(self):
        ours, theirs = os.pipe()
        os.close(ours)
        run = subprocess.run([str(kilter_binary()), "config", "show"], stdout=theirs, stderr=subprocess.PIPE, text=True,
                             check=False)
        os.close(theirs)
        self.assertEqual(run.returncode, 5)
        self.assertTrue(run.stderr.startswith("io: standard output: cannot be written: Broken pipe\n"), run.stderr)


class Config(unittest.TestCase):
    def test_what_is_shown_is_a_configuration_file(self):
        shown = run_kilter("config", "show", "--set", "tolerance=3 cm", "--set", "T_body_sensor.a=0 0 1.5 0 0 0 1")
        keys = tomllib.loads(shown.stdout)
        self.assertEqual(keys["tolerance"], 0.03)
        self.assertEqual(keys["T_body_sensor"], {"a": [0, 0, 1.5, 0, 0, 0, 1]})
        with TinyMission() as tiny:
            file = tiny.folder / "keys.toml"
            file.write_text(shown.stdout)
            self.assertEqual(run_kilter("config", "show", "--config", file).stdout, shown.stdout)

    def test_mountings_of_robots_of_any_name_and_of_all_are_read_back(self):
        place = "0 0 1.5 0 0 0 1"
        for robots, line in ((("",), "T_body_sensor = [0, 0, 1.5, 0, 0, 0, 1]\n"),
                             ((".Jörg's 车 # 1",), "T_body_sensor.\"Jörg's 车 # 1\" = [0, 0, 1.5, 0, 0, 0, 1]\n"),
                             (("", ".é"), 'T_body_sensor."" = [0, 0, 1.5, 0, 0, 0, 1]\n')):
            mounted = [word for robot in robots for word in ("--set", f"T_body_sensor{robot}={place}")]
            shown = run_kilter("config", "show", *mounted)
            self.assertIn("\n" + line, shown.stdout)
            with tempfile.TemporaryDirectory() as folder:
                file = Path(folder) / "keys.toml"
                file.write_text(shown.stdout, encoding="utf-8")
                again = run_kilter("config", "show", "--config", file)
            self.assertEqual((again.stdout, again.stderr), (shown.stdout, ""))

    def test_what_a_line_that_is_no_toml_meant_is_offered(self):
        for line, hint in (("tolerance = 10 cm", 'quote it: tolerance = "10 cm"'),
                           ("registration = oicp # the paper's", 'quote it: registration = "oicp"'),
                           ("tolerance: 0.1", "use =: tolerance = 0.1"),
                           ("tolerance : 5 %", 'use = and quotes: tolerance = "5 %"'),
                           ("[tolerance", "kilter explain config"), ("tolerance =", "kilter explain config"),
                           ("é = 1", "a robot of such a name stands in quotes: "),
                           (f"T_body_sensor = {[1.0] * 16}", "of a matrix, its last column x y z, then its rotation as a "),
                           (f"T_body_sensor = {[1.0] * 6}", "kilter explain config")):
            with self.subTest(line=line), tempfile.TemporaryDirectory() as folder:
                file = Path(folder) / "keys.toml"
                file.write_text(f"alpha = 0.01\n{line}\n", encoding="utf-8")
                run = run_kilter("config", "show", "--config", file)
                self.assertEqual((run.status, run.stdout), (2, ""))
                self.assertIn("keys.toml:2: ", run.stderr)
                self.assertIn(f"\n  try: {hint}", run.stderr)

    def test_promised_keys_are_there_with_their_defaults(self):
        keys = tomllib.loads(run_kilter("config", "show").stdout)
        self.assertEqual({key: keys.get(key) for key in KEYS}, KEYS)

    def test_json_gives_unit_range_and_meaning(self):
        keys = json.loads(run_kilter("config", "show", "--json").stdout)
        self.assertEqual(keys["tolerance"]["value"], 0.1)
        self.assertEqual(keys["tolerance"]["unit"], "m")
        self.assertTrue(all(row["doc"] and row["range"] for key, row in keys.items() if key != "T_body_sensor"))

    def test_the_seed_preset_changes_what_the_paper_does_otherwise(self):
        keys = tomllib.loads(run_kilter("config", "show", "--preset", "seed").stdout)
        self.assertEqual((keys["registration"], keys["floor"], keys["fit"]), ("oicp", "none", "moments"))


class Simulate(unittest.TestCase):
    def test_makes_a_mission_that_check_and_info_read(self):
        with tempfile.TemporaryDirectory() as folder:
            arguments = ("office", "-o", folder, "--robots", 1, "--beams", 16, "--columns", 180, "--scan-step", 4, "--json")
            run = run_kilter("simulate", *arguments)
            self.assertEqual(run.status, 0, run.stderr)
            made = json.loads(run.stdout)
            robots = json.loads(run_kilter("info", f"{folder}/mission", "--json").stdout)["robots"]
            self.assertEqual([robot["name"] for robot in robots], made["robots"])
            self.assertEqual(sum(robot["clouds"] for robot in robots), made["scans"])
            again = run_kilter("simulate", *arguments)
            self.assertEqual((again.status, again.stdout), (2, ""), "a mission is not overwritten unasked")
            self.assertEqual(run_kilter("simulate", *arguments, "--replace").stdout, run.stdout)

    def test_a_scene_that_does_not_exist_is_a_usage_error(self):
        run = run_kilter("simulate", "offcie", "-o", "nowhere")
        self.assertEqual(run.status, 2)
        self.assertIn("office", run.stderr)


class Memory(unittest.TestCase):
    def test_a_size_that_is_none_is_refused_by_every_command(self):
        for command in (("check", "."), ("info", "."), ("register", "a.bin", "b.bin"), ("submaps", ".", "-o", "d"),
                        ("report", ".", "-o", "r.html"), ("simulate", "office", "-o", "d"), ("config", "show")):
            self.assertEqual(run_kilter(*command, "--memory", "4iB").status, 2)
            run = run_kilter(*command, "--memory", "bogus")
            self.assertEqual((run.status, run.stdout), (2, ""), command)
            self.assertIn('--memory: expected a size such as 512M or 4G, found "bogus"', run.stderr)


class Explain(unittest.TestCase):
    def test_every_code_and_finding_is_explained(self):
        explanations = json.loads(run_kilter("explain", "--json").stdout)
        for name in ("usage", "parse", "truncated", "cancelled", "inconsistent", "unverified", "undetermined"):
            self.assertGreater(len(explanations[name]), 40)
        for name in explanations:
            self.assertTrue(run_kilter("explain", name).stdout.startswith(f"{name}\n  "))
        self.assertTrue(run_kilter("explain", "PARSE").stdout.startswith("parse\n"))

    def test_no_code_that_can_be_printed_is_missing(self):
        """Held against the sources: a code that somebody adds has to be explained, or this fails."""
        explained = json.loads(run_kilter("explain", "--json").stdout)
        errors = re.search(r"enum class ErrorCode \{(.*?)\};", source("src/kilter/base/expected.h"), re.S)
        names = [re.sub(r"(?<!^)([A-Z])", r"-\1", name).lower() for name in re.findall(r"\bk([A-Z]\w+),", errors[1])]
        oddities = re.findall(r'(?:say\(|push_back\(\{)"([a-z-]+)"', source("src/kilter/io/find_oddities.cc"))
        schema = json.loads(source("docs/result.schema.json"))["$defs"]
        verdicts = [word for of in ("pair", "system") for word in schema[of]["properties"]["verdict"]["enum"]]
        self.assertGreaterEqual((len(names), len(set(oddities)), len(verdicts)), (17, 11, 6))
        self.assertEqual([name for name in names + oddities + verdicts if name not in explained], [])

    def test_keys_of_a_pair_are_explained_as_they_stand_in_the_result(self):
        evidence = re.findall(r"^\| `(\w+)` \|", source("docs/verdicts.md"), re.M)
        self.assertIn("conflict_registered", evidence)
        others = ["offset_m", "offset_vector", "gap_m", "p_value", "p_inconsistent", "unobservable", "minimum_detectable_m",
                  "certificate_m", "certificate_of", "frames", "certificate_excludes", "log_odds", "decided", "constraint", "cycles", "theta_oicp", "gamma_literal"]
        others += ["overlap", "matched", "offset_interval_m", "offset_deg", "mu", "sigma", "mu_t", "var_t", "covariance",
                   "covariance_scale", "log_probability", "too_little_overlap", "verdict", "reason", "kind", "sequential",
                   "local", "global", "offset_low_m", "offset_high_m", "offset_x", "evidence_bend_m_log_ratio"]
        for key in evidence + others:
            run = run_kilter("explain", key)
            self.assertEqual((run.status, run.stderr), (0, ""), key)


class Info(unittest.TestCase):
    def test_counts_what_a_mission_holds(self):
        with TinyMission() as tiny:
            run = run_kilter("info", tiny.mission, "--json")
            robots = json.loads(run.stdout)["robots"]
            self.assertEqual([robot["name"] for robot in robots], ["a", "b"])
            self.assertEqual(robots[0]["clouds"], 13)
            self.assertEqual(robots[0]["first_cloud_points"], 480 * 32)
            self.assertEqual(robots[0]["likely_submaps"], 3)
            self.assertAlmostEqual(robots[0]["path_length_m"], 24.0, delta=0.1)
            text = run_kilter("info", tiny.mission)
            self.assertEqual(text.status, 0)
            self.assertIn("mission, 26 scans, 2 robots", text.stdout)
            self.assertIn("Likely 6 submaps", text.stdout)
            self.assertIn("poses matched 13 of 13", text.stdout)
            self.assertEqual((robots[0]["flattest_axis"], robots[0]["lengths_look_metric"]), ("z", True))
            self.assertIn("z seems to be up", text.stdout)
            self.assertIn("lengths look like metres", text.stdout)
            self.assertIn("Nothing odd found", text.stdout)

    def test_says_the_unit_of_stamps(self):
        with TinyMission() as tiny:
            for unit, factor in {"s": 1, "ms": 10**3, "us": 10**6, "ns": 10**9}.items():
                mission = tiny.copy(f"in_{unit}")
                poses = mission / "a" / "poses.tum"
                rows = [line.split(maxsplit=1)[1] for line in poses.read_text().splitlines() if line[:1].isdigit()]
                poses.write_text("".join(f"{(1403636579 + i) * factor} {row}\n" for i, row in enumerate(rows)))
                self.assertIn(f"stamps in {unit}: Unix time, 2014-06-24 19:02:59 UTC, 2.0 s", run_kilter("info", mission).stdout)
                robots = json.loads(run_kilter("info", mission, "--json").stdout)["robots"]
                self.assertEqual((robots[0]["stamp_unit"], robots[0]["first_stamp_s"]), (unit, 1403636579))

    def test_says_what_is_wrong_before_any_work(self):
        with TinyMission() as tiny:
            mission = tiny.copy("short")
            (mission / "a" / "scans" / "000000.bin").write_bytes(b"x" * 17)
            run = run_kilter("info", mission)
            self.assertEqual((run.status, run.stdout), (3, ""))
            self.assertIn("000000.bin", run.stderr)


if __name__ == "__main__":
    main()
