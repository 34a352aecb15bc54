# SPDX-FileCopyrightText: The kilter authors
# SPDX-License-Identifier: BSD-3-Clause
"""The acceptance index of two occupancy grids (Birk & Carpin 2006), here of two submaps in 3-D at the map's pose.

    ai = agree / (agree + disagree), 0 if nothing agrees

counts cells that both submaps know: *agree* those with the same state, *disagree* those that are occupied in one and free
in the other. A known cell of the source goes by its centre into the target's lattice: the cell there that holds it is
what it is compared with. Each is counted once, so two of the source may meet the same one of the target. Edges of 0.1,
0.2 and 0.4 m are tried; a cell larger than a voxel is occupied if any voxel in it is, and free if all that is known of it
is free. Scores are 1 - ai, larger for worse pairs:

- *acceptance index*: as in the paper. Most cells are free in both, which says little in 3-D;
- *acceptance index of surfaces*: cells that are free in both are left out.

States are read from the trees that `kilter submaps` writes (.ot), by code that does not link kilter.
"""
import itertools

import numpy as np

CELLS_M = (0.1, 0.2, 0.4)
UNKNOWN, FREE, OCCUPIED = 0, 1, 2  # the largest state among a cell's voxels is the cell's
LEVELS = 16  # of a tree; the root's cube has 2^16 voxels an edge, the origin in its middle
BLOCK_LEVEL = 3
BLOCK = 1 << BLOCK_LEVEL  # voxels an edge
CHUNK = 1 << 16  # cells compared at once, so that they stay in the cache


def read_tree(path):
    """(voxel's edge [m], log-odds of the nodes, bits of their children): depth first, a node before its children."""
    head, _, body = path.read_bytes().partition(b"\ndata\n")
    words = dict(line.split(" ", 1) for line in head.decode("ascii").splitlines() if not line.startswith("#"))
    nodes = np.frombuffer(body, [("log_odds", "<f4"), ("children", "u1")], int(words["size"]))
    return float(words["res"]), nodes["log_odds"].copy(), nodes["children"].copy()


def ends_of(children):
    """Index of the last node of each node's subtree."""
    count = np.unpackbits(children[:, None], axis=1).sum(axis=1, dtype=np.int64)
    n = len(count)
    # Subtrees announced but not begun, after each node. A subtree ends where one less is pending than before it.
    pending = np.cumsum(count - 1)
    order = np.argsort(pending.astype(np.int16), kind="stable")
    keys = pending[order] * n + order
    inner = np.flatnonzero(children)
    ends = np.arange(n)
    ends[inner] = order[np.searchsorted(keys, (pending - count)[inner] * n + inner)]
    return ends


def leaves_of(log_odds, children):
    """Yields (level, lowest voxels (n, 3), states) of the leaves, by level; a leaf's cube has 2^level voxels an edge."""
    ends = ends_of(children)
    states = np.where(log_odds >= 0.0, OCCUPIED, FREE).astype(np.uint8)
    at, corners = np.zeros(1, np.int64), np.zeros((1, 3), np.int32)
    for level in range(LEVELS, -1, -1):
        is_leaf = children[at] == 0
        yield level, (corners[is_leaf] << level) - (1 << LEVELS - 1), states[at[is_leaf]]
        at, corners = at[~is_leaf], corners[~is_leaf]
        child = at + 1
        below = []
        for octant in range(8):
            there = (children[at] >> octant & 1).astype(bool)
            offset = np.array([octant & 1, octant >> 1 & 1, octant >> 2], np.int32)
            below.append((child[there], 2 * corners[there] + offset))
            child[there] = ends[child[there]] + 1
        at, corners = (np.concatenate(parts) for parts in zip(*below))


class Grid:
    """States in blocks of `edge` cells an edge, and where in space each block is."""

    def __init__(self, cell_m, edge, table, low, states):
        self.cell_m, self.edge = cell_m, edge
        self.table = table  # number of the block at each place, 0 = none; nothing but 0 on its border
        self.low = low  # the table's first place, in blocks
        self.states = states  # (blocks, edge, edge, edge); the first is unknown

    @classmethod
    def read(cls, path):
        """Of an .ot file, at its own resolution."""
        cell_m, log_odds, children = read_tree(path)
        parts = []
        for level, corners, states in leaves_of(log_odds, children):
            for offset in itertools.product(range(0, 1 << level, BLOCK), repeat=3) if len(states) else ():
                parts.append((min(level, BLOCK_LEVEL), corners + np.array(offset, np.int32), states))
        low = np.min([corners.min(axis=0) for _, corners, _ in parts], axis=0) // BLOCK - 1
        high = np.max([corners.max(axis=0) for _, corners, _ in parts], axis=0) // BLOCK + 1
        table = np.zeros(high - low + 1, np.int32)
        places = [tuple((corners // BLOCK - low).T) for _, corners, _ in parts]
        for place in places:
            table[place] = 1
        there = table > 0
        table[there] = np.arange(1, there.sum() + 1)
        filled = np.zeros((there.sum() + 1, BLOCK, BLOCK, BLOCK), np.uint8)
        for (level, corners, states), place in zip(parts, places):
            x, y, z = (corners % BLOCK).T
            for dx, dy, dz in itertools.product(range(1 << level), repeat=3):
                filled[table[place], x + dx, y + dy, z + dz] = states
        return cls(cell_m, BLOCK, table, low, filled)

    def coarser(self):
        """The grid of cells twice as large."""
        half = self.edge // 2
        states = self.states.reshape(-1, half, 2, half, 2, half, 2).max(axis=(2, 4, 6))
        return Grid(2 * self.cell_m, half, self.table, self.low, states)

    def known(self):
        """(centres in cells, 3 x n; states) of all cells that are not unknown."""
        block, *within = np.nonzero(self.states)
        places = np.zeros((len(self.states), 3), np.int32)
        places[self.table[self.table > 0]] = np.argwhere(self.table) + self.low
        centres = [places[block, k] * self.edge + within[k] + np.float32(0.5) for k in range(3)]
        return np.stack(centres).astype(np.float32), self.states[(block, *within)]

    def states_at(self, at):
        """Of the cells that hold points (3 x n, in cells)."""
        cells = np.floor(at).astype(np.int32)
        places, within = cells // self.edge, cells % self.edge
        places = [np.clip(places[k] - self.low[k], 0, self.table.shape[k] - 1) for k in range(3)]
        return self.states[(self.table[tuple(places)], *within)]


def meetings(target, source_known, T_target_source):
    """How many cells of the source in each state (row) fall into the target's cells in each (column), 3 x 3."""
    R = T_target_source[:3, :3].astype(np.float32)
    t = (T_target_source[:3, 3:] / target.cell_m).astype(np.float32)
    centres, states = source_known
    counts = np.zeros(9, np.int64)
    for first in range(0, len(states), CHUNK):
        chunk = slice(first, first + CHUNK)
        counts += np.bincount(3 * states[chunk] + target.states_at(R @ centres[:, chunk] + t), minlength=9)
    return counts.reshape(3, 3)


def acceptance_index(agree, disagree):
    return agree / (agree + disagree) if agree else 0.0


def scores_of(counts, cell_m):
    """Both scores from the meetings of a pair, as a dict."""
    disagree = counts[FREE, OCCUPIED] + counts[OCCUPIED, FREE]
    surfaces = counts[OCCUPIED, OCCUPIED]
    return {f"acceptance index {cell_m}": 1.0 - acceptance_index(surfaces + counts[FREE, FREE], disagree),
            f"acceptance index of surfaces {cell_m}": 1.0 - acceptance_index(surfaces, disagree)}


def grids_of(folder, submaps):
    """Of each submap a dict from the cell's edge to its grid, from the output folder of `kilter submaps`."""
    paths = {robot: iter(sorted((folder / robot / "submaps").glob("*.ot"))) for robot in {s["robot"] for s in submaps}}
    for submap in submaps:
        grids = [Grid.read(next(paths[submap["robot"]]))]
        grids += [grids[0].coarser(), grids[0].coarser().coarser()]
        yield {d: grid for grid in grids for d in CELLS_M if abs(grid.cell_m - d) < 1e-6}


def add(rows, truth, folder):
    """Adds both scores to the `baselines` of every row."""
    number = {submap["id"]: i for i, submap in enumerate(truth.submaps)}
    grids = list(grids_of(folder, truth.submaps))
    for b, source in enumerate(grids):
        known = {d: grid.known() for d, grid in source.items()}
        for row in (row for row in rows if number[row["source"]] == b):
            a = number[row["target"]]
            T_target_source = np.linalg.inv(truth.frames[a]) @ truth.frames[b]
            for d in known:
                row["baselines"].update(scores_of(meetings(grids[a][d], known[d], T_target_source), d))
