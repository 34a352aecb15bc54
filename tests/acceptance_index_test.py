# SPDX-FileCopyrightText: The kilter authors
# SPDX-License-Identifier: BSD-3-Clause
"""The acceptance index that the accuracy benchmark holds kilter against, on grids made by hand."""

import struct
import sys
import tempfile
import unittest
from pathlib import Path

try:
    import numpy as np
except ImportError:
    sys.exit(77)

ROOT = Path(__file__).resolve().parent.parent
sys.path.insert(0, str(ROOT / "benchmarks" / "accuracy"))
import acceptance_index as ai  # noqa: E402  (found only after the line above)
import suite  # noqa: E402

FREE, OCCUPIED = ai.FREE, ai.OCCUPIED
LOG_ODDS = {FREE: -0.405, OCCUPIED: 0.847}
MIDDLE = 1 << 15


def nodes_of(cells, level=16):
    """An octree's bytes from {(x, y, z) counted from the root's corner: (level of the leaf, state)}."""
    if len(cells) == 1 and next(iter(cells.values()))[0] == level:
        return [struct.pack("<fB", LOG_ODDS[next(iter(cells.values()))[1]], 0)]
    parts = [{} for _ in range(8)]
    for (x, y, z), leaf in cells.items():
        bits = [c >> (level - 1) & 1 for c in (x, y, z)]
        parts[bits[0] + 2 * bits[1] + 4 * bits[2]][x, y, z] = leaf
    mask = sum(1 << k for k, part in enumerate(parts) if part)
    highest = max(LOG_ODDS[state] for _, state in cells.values())
    return [struct.pack("<fB", highest, mask), *(node for part in parts if part for node in nodes_of(part, level - 1))]


def grid_of(cells, pruned=None):
    """The grid read back from a file that has {(x, y, z): state} and, of pruned leaves, {(x, y, z): (level, state)}."""
    leaves = {cell: (0, state) for cell, state in cells.items()} | (pruned or {})
    nodes = nodes_of({tuple(c + MIDDLE for c in cell): leaf for cell, leaf in leaves.items()})
    head = f"# Octomap OcTree file\n# by hand\nid OcTree\nsize {len(nodes)}\nres 0.1\ndata\n"
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder, "000000.ot")
        path.write_bytes(head.encode("ascii") + b"".join(nodes))
        return ai.Grid.read(path)


def cells_of(grid):
    centres, states = grid.known()
    return {tuple(cell): state for cell, state in zip(np.floor(centres).astype(int).T.tolist(), states.tolist())}


def scores_of(target, source, T_target_source=np.eye(4)):
    scores = ai.scores_of(ai.meetings(target, source.known(), T_target_source), 0.1)
    return scores["acceptance index 0.1"], scores["acceptance index of surfaces 0.1"]


def moved(x_m=0.0, y_m=0.0, z_m=0.0):
    T = np.eye(4)
    T[:3, 3] = x_m, y_m, z_m
    return T


def room(n=12):
    """Free cells in front of a wall of occupied ones at y = 5."""
    return {(x, y, z): OCCUPIED if y == 5 else FREE for x in range(n) for y in range(6) for z in range(n)}


class Trees(unittest.TestCase):
    def test_cells_come_back_on_both_sides_of_the_origin(self):
        cells = {(0, 0, 0): OCCUPIED, (-1, -1, -1): FREE, (7, -8, 9): FREE, (300, -200, 40): OCCUPIED, (301, -200, 40): FREE}
        self.assertEqual(cells_of(grid_of(cells)), cells)

    def test_random_cells_come_back(self):
        rng = np.random.default_rng(6)
        cells = {tuple(cell): int(rng.integers(FREE, OCCUPIED + 1)) for cell in rng.integers(-20, 20, (3000, 3)).tolist()}
        self.assertEqual(cells_of(grid_of(cells)), cells)

    def test_a_pruned_leaf_is_all_cells_of_its_cube(self):
        for level in (1, 2, 3, 4):
            edge = 1 << level
            found = cells_of(grid_of({(-1, 0, 0): OCCUPIED}, {(edge, -edge, 0): (level, FREE)}))
            cube = {(edge + x, -edge + y, z): FREE for x in range(edge) for y in range(edge) for z in range(edge)}
            self.assertEqual(found, {(-1, 0, 0): OCCUPIED, **cube})


class Grids(unittest.TestCase):
    def test_a_larger_cell_is_occupied_if_any_is_and_free_if_nothing_else_is_known(self):
        grid = grid_of({(0, 0, 0): FREE, (1, 1, 1): OCCUPIED, (2, 0, 0): FREE, (-1, 0, 0): FREE, (-2, 1, 0): FREE})
        self.assertEqual(cells_of(grid.coarser()), {(0, 0, 0): OCCUPIED, (1, 0, 0): FREE, (-1, 0, 0): FREE})
        self.assertEqual(cells_of(grid.coarser().coarser()), {(0, 0, 0): OCCUPIED, (-1, 0, 0): FREE})
        self.assertAlmostEqual(grid.coarser().coarser().cell_m, 0.4)

    def test_what_lies_outside_is_unknown(self):
        grid = grid_of({(0, 0, 0): FREE})
        self.assertEqual(grid.states_at(np.array([[0.5, 1.5, -900.0, 900.0]] * 3)).tolist(), [FREE, 0, 0, 0])


class AcceptanceIndex(unittest.TestCase):
    def test_the_same_map_is_accepted(self):
        grid = grid_of(room())
        self.assertEqual(scores_of(grid, grid), (0.0, 0.0))

    def test_a_wall_one_cell_off_disagrees_as_counted_by_hand(self):
        cells = room()
        grid = grid_of(cells)
        # Of the source's six layers in y, five meet layers 0 to 4: four free in both, one occupied in free space.
        self.assertEqual(scores_of(grid, grid, moved(y_m=-0.1)), (1.0 - 4 / 5, 1.0))

    def test_a_doubled_wall_agrees_in_part(self):
        target = grid_of({(0, 0, 0): OCCUPIED, (1, 0, 0): OCCUPIED, (2, 0, 0): FREE, (3, 0, 0): FREE, (4, 0, 0): FREE})
        source = grid_of({(0, 0, 0): OCCUPIED, (1, 0, 0): FREE, (2, 0, 0): OCCUPIED, (3, 0, 0): FREE, (9, 0, 0): FREE})
        self.assertEqual(ai.meetings(target, source.known(), np.eye(4)).tolist(), [[0, 0, 0], [1, 1, 1], [0, 1, 1]])
        self.assertEqual(scores_of(target, source), (1.0 - 2 / 4, 1.0 - 1 / 3))

    def test_nothing_in_common_is_not_accepted(self):
        grid = grid_of(room())
        self.assertEqual(scores_of(grid, grid, moved(x_m=50.0)), (1.0, 1.0))

    def test_a_turned_pair_is_that_of_cells_looked_up_one_by_one(self):
        rng = np.random.default_rng(7)
        cells = [{tuple(cell): int(rng.integers(FREE, OCCUPIED + 1)) for cell in rng.integers(-15, 15, (9000, 3)).tolist()}
                 for _ in range(2)]
        T = moved(0.234, -0.117, 0.051)
        T[:3, :3] = suite.rotation_about(np.array([0.6, 0.0, 0.8]), 0.7)
        expected = np.zeros((3, 3), int)
        for cell, state in cells[1].items():
            at = np.floor((T[:3, :3] @ (0.1 * (np.array(cell) + 0.5)) + T[:3, 3]) / 0.1).astype(int)
            expected[state, cells[0].get(tuple(at.tolist()), 0)] += 1
        counts = ai.meetings(grid_of(cells[0]), grid_of(cells[1]).known(), T)
        self.assertEqual(counts.tolist(), expected.tolist())
        self.assertGreater(counts[FREE, OCCUPIED], 100)


if __name__ == "__main__":
    unittest.main()
