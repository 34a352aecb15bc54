# SPDX-FileCopyrightText: The kilter authors
# SPDX-License-Identifier: BSD-3-Clause
"""The paper's own claims and the product's first promises, seen from outside: whatever is compared here is computed a
second time in this file, from the formulas, or follows from how the clouds were made."""

from __future__ import annotations

import json
import math
import random
import shutil
import tempfile
import unittest
from pathlib import Path

import figure3
from kilter_runner import main, run_kilter

IDENTITY = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0)


def normal_pdf(x: float) -> float:
    return math.exp(-0.5 * x * x) / math.sqrt(2.0 * math.pi)


def normal_cdf(x: float) -> float:
    return 0.5 * math.erfc(-x / math.sqrt(2.0))


def truncated(mu: float, sigma: float, d: float) -> tuple[float, float]:
    """Eq. (13)-(14) with the parent's mu and sigma on [0, d]; fine where the parent is not far outside."""
    alpha, beta = -mu / sigma, (d - mu) / sigma
    mass = normal_cdf(beta) - normal_cdf(alpha)
    q = (normal_pdf(alpha) - normal_pdf(beta)) / mass
    variance = sigma**2 * (1.0 + (alpha * normal_pdf(alpha) - beta * normal_pdf(beta)) / mass - q * q)
    return mu + sigma * q, variance


def wall(seed: int, spread: float = 0.005) -> list[tuple[float, float, float]]:
    """A wall at x = 3.047, 8 m wide and 3 m high, as a laser scanner samples it."""
    rng = random.Random(seed)
    return [(3.047 + rng.gauss(0.0, spread), rng.uniform(-4.0, 4.0), rng.uniform(0.0, 3.0)) for _ in range(12000)]


def corner(seed: int) -> list[tuple[float, float, float]]:
    """The wall with a floor and a second wall: three directions, every shift shows."""
    rng = random.Random(seed + 1000)
    noise = lambda: rng.gauss(0.0, 0.005)  # noqa: E731
    floor = [(rng.uniform(-1.0, 3.0), rng.uniform(-4.0, 4.0), noise()) for _ in range(12000)]
    side = [(rng.uniform(-1.0, 3.0), 4.0 + noise(), rng.uniform(0.0, 3.0)) for _ in range(6000)]
    return wall(seed) + floor + side


def seen_from(cloud: list, yaw: float) -> tuple[list, tuple]:
    """The cloud in a frame turned by `yaw` about z at (1, 0.5, 0.2), and that frame's pose: another robot's lattice."""
    c, s = math.cos(yaw), math.sin(yaw)
    turned = [(c * (x - 1.0) + s * (y - 0.5), -s * (x - 1.0) + c * (y - 0.5), z - 0.2) for x, y, z in cloud]
    return turned, (1.0, 0.5, 0.2, 0.0, 0.0, math.sin(0.5 * yaw), math.cos(0.5 * yaw))


class Missions(unittest.TestCase):
    """Writes missions of finished submaps and reads results."""

    def setUp(self) -> None:
        self.folder = Path(tempfile.mkdtemp(prefix="kilter_paper_"))
        self.addCleanup(shutil.rmtree, self.folder)

    def robot(self, name: str, clouds: list, poses: list) -> Path:
        place = self.folder / name
        shutil.rmtree(place, ignore_errors=True)
        (place / "submaps").mkdir(parents=True)
        for i, cloud in enumerate(clouds):
            (place / "submaps" / f"{i:06d}.pcd").write_text(figure3.cloud(cloud))
        lines = (" ".join(map(repr, (float(i), *pose))) for i, pose in enumerate(poses))
        (place / "poses.tum").write_text("\n".join(lines) + "\n")
        return place

    def check(self, *arguments: object) -> tuple[int, dict]:
        run = run_kilter("check", *arguments, "-o", self.folder / "out", "--quiet")
        self.assertIn(run.status, (0, 1, 4), run.stderr)
        return run.status, json.loads((self.folder / "out" / "result.json").read_text())

    def pair_of(self, first: list, second: list, pose: tuple, *settings: str) -> dict:
        """The one pair of two robots with a submap each, the second placed at `pose`."""
        a = self.robot("a", [first], [IDENTITY])
        b = self.robot("b", [second], [pose])
        flags = [flag for setting in settings for flag in ("--set", setting)]
        _, result = self.check(f"a={a}", f"b={b}", *flags)
        self.assertLessEqual(len(result["pairs"]), 1)
        return result["pairs"][0] if result["pairs"] else {"verdict": "unverified", "gamma": None}


class TheFormulas(Missions):
    def test_lines_that_meet_at_an_angle_give_the_papers_uniform_law(self) -> None:
        along, tilted = figure3.lines()
        pair = self.pair_of(along, tilted, IDENTITY, "resolution=0.01")
        kept = figure3.PICTURE.read_text(encoding="utf-8")
        self.assertEqual(figure3.draw(pair), kept, "make docs/figure3.svg again: tests/figure3.py")
        self.assertGreater(pair["matched"], 990)
        # Centres of 1 cm voxels stand for points: that much the distances may be off.
        self.assertAlmostEqual(pair["mu"], 0.5, delta=0.006)                   # Eq. (11): d / 2
        self.assertAlmostEqual(pair["sigma"] ** 2, 1.0 / 12.0, delta=0.0012)  # Eq. (11): d^2 / 12
        self.assertAlmostEqual(pair["var_t"], 1.0 / 18.0823, delta=0.0006)    # Eq. (14): d^2 / 18.1
        counts = pair["histogram"]["counts"]
        self.assertEqual(sum(counts), pair["matched"])
        self.assertLess(max(counts), 3 * pair["matched"] / len(counts))  # flat

    def test_truncated_moments_and_gamma_follow_from_mu_sigma_and_d(self) -> None:
        for shift in (0.0, 0.07, 0.3, 0.6):
            pair = self.pair_of(corner(1), corner(2), (shift, 0.5 * shift, 0.0, *IDENTITY[3:]))
            mu_t, var_t = truncated(pair["mu"], pair["sigma"], pair["d"])
            self.assertAlmostEqual(pair["mu_t"] / mu_t, 1.0, delta=1e-9)
            self.assertAlmostEqual(pair["var_t"] / var_t, 1.0, delta=1e-9)
            self.assertAlmostEqual(pair["gamma_literal"] * mu_t * var_t, 1.0, delta=1e-9)
            floored = max(mu_t, 0.25 * 0.1) * max(var_t, (0.15 * 0.1) ** 2)
            self.assertAlmostEqual(pair["gamma"] * floored, 1.0, delta=1e-9)
            if pair["theta"] is not None:
                self.assertAlmostEqual(pair["verified"], pair["theta"] - pair["gamma"], delta=1e-9 * pair["theta"])

    def test_each_direction_is_what_brute_force_says(self) -> None:
        rng = random.Random(5)
        blob = lambda n: [tuple(rng.uniform(0.0, 2.0) for _ in range(3)) for _ in range(n)]  # noqa: E731
        first, second = blob(900), blob(700)
        shift = (0.213, -0.117, 0.058)

        def centres(cloud: list) -> list:
            return [tuple((k + 0.5) * 0.1 for k in cell) for cell in {tuple(math.floor(v / 0.1) for v in p) for p in cloud}]

        def gamma(source: list, target: list, offset: tuple) -> float:
            moved = [tuple(v + o for v, o in zip(p, offset)) for p in source]
            distances = [min(math.dist(p, q) for q in target) for p in moved]
            distances = [v for v in distances if v <= 1.0]
            mean = math.fsum(distances) / len(distances)
            variance = math.fsum((v - mean) ** 2 for v in distances) / len(distances)
            mu_t, var_t = truncated(mean, math.sqrt(variance), 1.0)
            return 1.0 / (mu_t * var_t)

        pose = (*shift, *IDENTITY[3:])
        forward = self.pair_of(first, second, pose)
        self.assertAlmostEqual(forward["gamma_literal"] / gamma(centres(second), centres(first), shift), 1.0, delta=1e-9)
        # Renamed, so that the order swaps: the other direction of the same pair.
        a = self.robot("b", [first], [IDENTITY])
        b = self.robot("a", [second], [pose])
        _, result = self.check(f"b={a}", f"a={b}")
        backward = result["pairs"][0]
        self.assertEqual((backward["target"], backward["source"]), ("a/1", "b/1"))
        back = tuple(-v for v in shift)
        self.assertAlmostEqual(backward["gamma_literal"] / gamma(centres(first), centres(second), back), 1.0, delta=1e-9)
        self.assertEqual(forward["verdict"], backward["verdict"])


class WhatMustNotMatter(Missions):
    @staticmethod
    def numbers(value: object, path: str = "") -> dict:
        """All numbers of a document by their path."""
        if isinstance(value, dict):
            return {k: v for key, item in value.items() for k, v in WhatMustNotMatter.numbers(item, f"{path}.{key}").items()}
        if isinstance(value, list):
            return {k: v for i, item in enumerate(value) for k, v in WhatMustNotMatter.numbers(item, f"{path}[{i}]").items()}
        return {path: value} if isinstance(value, (int, float)) and not isinstance(value, bool) else {}

    def test_moving_the_whole_world_changes_no_number(self) -> None:
        poses = [IDENTITY, (0.08, 0.05, 0.01, 0.0, 0.0, 0.0, 1.0)]
        half = 0.5 * 0.9  # the world turned by 0.9 rad about z and carried away
        c, s = math.cos(2.0 * half), math.sin(2.0 * half)
        moved = [(c * x - s * y + 1234.5, s * x + c * y - 987.6, z + 321.0, 0.0, 0.0, math.sin(half), math.cos(half))
                 for x, y, z, *_ in poses]
        results = []
        for world in (poses, moved):
            a = self.robot("a", [corner(1)], world[:1])
            b = self.robot("b", [corner(2)], world[1:])
            results.append(self.check(f"a={a}", f"b={b}")[1])
        for key in ("pairs", "system"):
            here, there = (self.numbers(result[key]) for result in results)
            self.assertEqual(here.keys(), there.keys())
            for name, value in here.items():
                self.assertAlmostEqual(there[name], value, delta=1e-6 * max(1.0, abs(value)), msg=key + name)
        self.assertEqual([p["verdict"] for p in results[0]["pairs"]], [p["verdict"] for p in results[1]["pairs"]])


class DoubledWalls(Missions):
    def test_a_wall_doubled_by_20_cm_is_inconsistent_though_its_literal_gamma_is_high(self) -> None:
        cloud, pose = seen_from(wall(2, spread=0.001), 0.4)
        first, pushed = wall(1, spread=0.001), (pose[0] + 0.2, *pose[1:])
        self.assertEqual(self.pair_of(first, cloud, pushed)["verdict"], "inconsistent")
        # Between centroids all distances become equal and the variance vanishes: the literal score rises.
        aligned = self.pair_of(first, cloud, pose, "voxel_position=centroid")
        doubled = self.pair_of(first, cloud, pushed, "voxel_position=centroid")
        self.assertGreater(doubled["gamma_literal"], 2.0 * aligned["gamma_literal"])
        self.assertLess(doubled["gamma"], aligned["gamma"])  # the floor restores the order
        self.assertEqual(doubled["verdict"], "inconsistent")
        self.assertAlmostEqual(doubled["offset_m"], 0.2, delta=0.02)

    def test_small_gaps_are_measured_whatever_the_verdict(self) -> None:
        for gap in (0.05, 0.10):
            for scene in (wall, corner):
                pair = self.pair_of(scene(1), scene(2), (gap, *IDENTITY[1:]))
                self.assertAlmostEqual(pair["offset_m"], gap, delta=0.02)
                self.assertAlmostEqual(pair["gap_m"], gap, delta=0.01)
                low, high = pair["offset_interval_m"]
                self.assertLessEqual(low, pair["offset_m"])
                self.assertGreaterEqual(high, pair["offset_m"])
        self.assertEqual(self.pair_of(corner(1), corner(2), (0.05, *IDENTITY[1:]))["verdict"], "consistent")
        strict = self.pair_of(corner(1), corner(2), (0.05, *IDENTITY[1:]), "tolerance=3 cm")
        self.assertEqual(strict["verdict"], "inconsistent")

    def test_the_offset_points_from_where_the_map_has_it_to_where_it_belongs(self) -> None:
        pair = self.pair_of(corner(1), corner(2), (0.2, -0.1, 0.0, *IDENTITY[3:]))
        for found, planted in zip(pair["offset_vector"], (-0.2, 0.1, 0.0)):
            self.assertAlmostEqual(found, planted, delta=0.02)


class WithoutOverlap(Missions):
    def test_identical_submaps_have_a_finite_gamma_and_no_literal_one(self) -> None:
        pair = self.pair_of(corner(1), corner(1), IDENTITY)
        self.assertGreater(pair["gamma"], 1e4)
        self.assertIsNone(pair["gamma_literal"])
        self.assertEqual(pair["verdict"], "consistent")

    def test_a_pair_pushed_apart_is_never_consistent(self) -> None:
        for shift in (0.5, 1.0, 1.5, 2.5, 4.0, 7.0, 12.0, 30.0):
            for direction in ((1, 0, 0), (0, 1, 0), (0, 0, 1)):
                pose = (*(shift * axis for axis in direction), *IDENTITY[3:])
                self.assertNotEqual(self.pair_of(corner(1), corner(2), pose)["verdict"], "consistent", pose)

    def test_robots_that_never_meet_leave_the_map_undetermined(self) -> None:
        a = self.robot("a", [corner(1)], [IDENTITY])
        b = self.robot("b", [corner(2)], [(500.0, *IDENTITY[1:])])
        status, result = self.check(f"a={a}", f"b={b}")
        self.assertEqual(status, 4)
        self.assertEqual(result["system"]["verdict"], "undetermined")


if __name__ == "__main__":
    main()
