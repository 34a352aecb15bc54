# SPDX-FileCopyrightText: The kilter authors
# SPDX-License-Identifier: BSD-3-Clause
"""The figures and labels that docs/accuracy.md rests on, against cases worked out by hand."""

import sys
import unittest
from pathlib import Path

try:
    import numpy as np
except ImportError:
    sys.exit(77)

ROOT = Path(__file__).resolve().parent.parent
sys.path.insert(0, str(ROOT / "benchmarks" / "accuracy"))
import ablation  # noqa: E402  (found only after the line above)
import baselines  # noqa: E402
import labels  # noqa: E402
import scores  # noqa: E402
import suite  # noqa: E402


class Scores(unittest.TestCase):
    def test_discoveries_are_those_of_benjamini_and_hochberg(self):
        p = [0.009, 0.001, 0.014, 0.2, float("nan")]  # limits of four tests at 2 %: 0.005, 0.010, 0.015, 0.020
        self.assertEqual(scores.discoveries(p, 0.02).tolist(), [True, True, True, False, False])
        self.assertFalse(scores.discoveries([0.5, 0.02], 0.01).any())
        self.assertFalse(scores.discoveries([float("nan")], 0.01).any())

    def test_a_weight_stands_for_so_many_pairs(self):
        p, above = np.array([0.7, 0.7, 0.2]), np.array([1, 0, 0])
        twice = scores.calibration(np.append(p, 0.7), np.append(above, 1))[0]
        self.assertAlmostEqual(scores.weighted_calibration(p, above, [2, 1, 1]), twice)

    def test_area_counts_ties_half(self):
        self.assertEqual(scores.area([3, 4], [1, 2]), 1.0)
        self.assertEqual(scores.area([1, 2], [3, 4]), 0.0)
        self.assertEqual(scores.area([1, 2], [2, 0]), (1 + 0 + 1 + 0.5) / 4)
        self.assertTrue(np.isnan(scores.area([], [1])))

    def test_found_at_lets_no_more_good_ones_pass_than_asked(self):
        good = np.arange(200)  # two of them may exceed the limit
        self.assertEqual(scores.found_at([197, 198, 500, 600], good, 0.01), 0.75)
        self.assertEqual(scores.found_at([150, 500], np.arange(50), 0.01), 1.0)

    def test_curve_begins_at_nothing_and_ends_at_all(self):
        false, true = scores.curve(np.array([2.0, 3.0]), np.array([1.0, 2.0]))
        self.assertEqual(list(zip(false, true)), [(0.0, 0.0), (0.0, 0.5), (0.5, 1.0), (1.0, 1.0)])

    def test_calibration_of_an_honest_forecaster_is_zero(self):
        p = np.repeat([0.25, 0.75], 400)
        above = np.concatenate([np.tile([1, 0, 0, 0], 100), np.tile([1, 1, 1, 0], 100)])
        self.assertAlmostEqual(scores.calibration(p, above)[0], 0.0)
        self.assertAlmostEqual(scores.calibration(p, 1 - above)[0], 0.5)

    def test_log_loss_of_a_coin_is_ln_two(self):
        self.assertAlmostEqual(scores.log_loss(np.zeros(4), np.array([1, 0, 1, 0], bool)), np.log(2))

    def test_logistic_fit_separates(self):
        x = np.array([[-2.0], [-1.0], [1.0], [2.0]])
        w = scores.logistic_fit(x, np.array([0.0, 0.0, 1.0, 1.0]))
        self.assertGreater(w[0], 1.0)
        self.assertAlmostEqual(w[1], 0.0, places=6)


class Labels(unittest.TestCase):
    def test_quaternions_turn_as_their_matrix_does(self):
        rng = np.random.default_rng(3)
        for _ in range(20):
            axis = rng.normal(size=3)
            R = suite.rotation_about(axis / np.linalg.norm(axis), rng.uniform(-np.pi, np.pi))
            again = labels.to_matrix([0, 0, 0, *labels.quaternion_of(R)])[:3, :3]
            np.testing.assert_allclose(again, R, atol=1e-9)

    def test_injected_errors_have_the_size_that_they_say(self):
        rng = np.random.default_rng(4)
        for direction in suite.DIRECTIONS:
            T = suite.draw_error(0.2, 0.03, direction, rng)
            shift = np.linalg.norm(T[:3, 3])
            angle = np.arccos(np.clip((np.trace(T[:3, :3]) - 1) / 2, -1, 1))
            self.assertIn(round(shift, 9), {"roll": (0.0,), "pitch": (0.0,), "yaw": (0.0,)}.get(direction, (0.2,)))
            self.assertIn(round(angle, 6), {"ahead": (0.0,), "left": (0.0,), "up": (0.0,)}.get(direction, (0.03,)))


def row_of(displacement_m, log_ratio, reason="", **pieces):
    both = {"displacement": {"value": displacement_m, "log_ratio": log_ratio},
            "disagreement": {"value": displacement_m, "log_ratio": log_ratio},
            "support": {"value": 1000, "null": 3000}}
    return {"reason": reason, "pieces": {**both, **pieces}}


class Ablation(unittest.TestCase):
    def test_a_piece_that_is_left_out_no_longer_decides(self):
        moved = row_of(0.4, 50.0)
        self.assertEqual(ablation.decide(moved), "inconsistent")
        ambiguous = row_of(0.4, 50.0, ambiguity={"value": 0.9})
        self.assertEqual(ablation.decide(ambiguous), "unverified")
        self.assertEqual(ablation.decide(ambiguous, "ambiguity"), "inconsistent")
        ambiguous["pieces"]["disagreement"]["log_ratio"] = 6.0  # as the program bounds it
        self.assertEqual(ablation.decide(ambiguous, "ambiguity"), "inconsistent")
        self.assertEqual(ablation.decide(ambiguous, "neighbours"), "unverified")
        other_sides = row_of(0.2, 50.0, reason="but few voxels show a side that both saw, and no free space speaks")
        self.assertEqual(ablation.decide(other_sides), "unverified")
        self.assertEqual(ablation.decide(other_sides, "sides seen by both"), "inconsistent")
        bent = row_of(0.03, -30.0)
        bent["pieces"]["disagreement"] = {"value": 0.5, "log_ratio": 40.0}
        self.assertEqual(ablation.decide(bent), "inconsistent")
        self.assertEqual(ablation.decide(bent, "bend"), "consistent")
        contradicted = row_of(0.4, 50.0, reason="of the 3 around it, 3 ask for another correction")
        contradicted["pieces"]["conflict"] = {"value": 0.6, "log_ratio": 60.0}
        self.assertEqual(ablation.decide(contradicted), "inconsistent")
        self.assertEqual(ablation.decide(contradicted, "free space alone"), "unverified")

    def test_good_pairs_are_consistent_unless_something_could_hide(self):
        self.assertEqual(ablation.decide(row_of(0.02, -40.0)), "consistent")
        self.assertEqual(ablation.decide(row_of(0.02, -40.0, reason="nothing fixes it and could hide 2 m")), "unverified")
        self.assertEqual(ablation.decide({"reason": "not a pair"}), "unverified")


class Baselines(unittest.TestCase):
    def test_entropy_of_a_doubled_wall_is_above_that_of_one(self):
        try:
            baselines.tree_of(np.zeros((1, 3)))
        except ImportError:
            self.skipTest("needs scipy")
        rng = np.random.default_rng(5)
        wall = np.stack([rng.uniform(0, 4, 3000), 0.01 * rng.normal(size=3000), rng.uniform(0, 2, 3000)], axis=1)
        tree = baselines.tree_of(wall)
        same = baselines.scores_of(wall, wall, tree, tree)
        moved = wall + [0.0, 0.2, 0.0]
        apart = baselines.scores_of(wall, moved, tree, baselines.tree_of(moved))
        for name in ("rmse 0.5", "ndt 0.5", "entropy 0.5", "coral 0.5"):
            self.assertGreater(apart[name], same[name], name)


if __name__ == "__main__":
    unittest.main()
