# SPDX-FileCopyrightText: The kilter authors
# SPDX-License-Identifier: BSD-3-Clause
"""What others measure on the same pairs, from the definitions in their papers; every score is larger for worse pairs.

All but the last are given the voxels of 0.1 m where the map has them, and those of each submap that lie within `reach` of
the other's box. Radii are tried over a range and the tables show each method's best, which favours it.

- *fitness* and *rmse* of ICP: the share of voxels without a neighbour within d, and the RMS distance of the rest;
- *ndt*: minus the mean likelihood under normal distributions in cells (Magnusson 2009), cells of size d;
- *entropy*: mean map entropy of the union (Droeschel & Behnke 2014): differential entropy of neighbourhoods of radius d;
- *coral*: joint minus separate differential entropy over the overlap (Adolfsson et al. 2021), untrained; its two
  entropies are kept too, for the logistic fit;
- *acceptance index*, and the same *of surfaces* (Birk & Carpin 2006): what two occupancy grids with cells of size d know
  in common and disagree about (acceptance_index.py).
"""
import numpy as np

import acceptance_index

RADII_M = (0.3, 0.5, 1.0)
# The d that the tables choose from, by method.
METHODS = {**dict.fromkeys(("fitness", "rmse", "ndt", "entropy", "coral"), RADII_M),
           **dict.fromkeys(("acceptance index", "acceptance index of surfaces"), acceptance_index.CELLS_M)}
NEIGHBOURS = 64  # of a neighbourhood, at most
POINTS = 1500  # of a pair, evenly picked
ENOUGH = 6  # points for a covariance


def entropies(tree_points, tree, at, radius_m):
    """0.5 ln det(2 pi e Sigma) of the neighbourhoods of radius_m; nan where there are fewer than ENOUGH points."""
    distances, indices = tree.query(at, k=NEIGHBOURS, distance_upper_bound=radius_m)
    there = np.isfinite(distances)
    points = tree_points[np.where(there, indices, 0)]
    n = there.sum(axis=1)
    weights = there[:, :, None] / np.maximum(n, 1)[:, None, None]
    mean = (points * weights).sum(axis=1)
    arms = (points - mean[:, None]) * np.sqrt(weights)
    covariance = np.einsum("nki,nkj->nij", arms, arms) + 1e-6 * np.eye(3)
    values = 0.5 * np.log(np.linalg.det(2 * np.pi * np.e * covariance))
    return np.where(n >= ENOUGH, values, np.nan)


class Cells:
    """Normal distributions of a submap's voxels in cells."""

    def __init__(self, points, size_m):
        self.size_m = size_m
        keys, inverse = np.unique(np.floor(points / size_m).astype(np.int64), axis=0, return_inverse=True)
        count = np.bincount(inverse)
        mean = np.stack([np.bincount(inverse, points[:, k]) for k in range(3)], axis=1) / count[:, None]
        arms = points - mean[inverse]
        second = np.empty((len(keys), 3, 3))
        for a in range(3):
            for b in range(3):
                second[:, a, b] = np.bincount(inverse, arms[:, a] * arms[:, b])
        keep = count >= ENOUGH
        self.index = {tuple(key): i for i, key in enumerate(keys[keep])}
        self.mean = mean[keep]
        covariance = second[keep] / (count[keep] - 1)[:, None, None] + 1e-3 * np.eye(3)
        self.precision = np.linalg.inv(covariance)

    def likelihood(self, points):
        at = np.array([self.index.get(tuple(key), -1) for key in np.floor(points / self.size_m).astype(np.int64)])
        arms = points - self.mean[np.maximum(at, 0)]
        squares = np.einsum("ni,nij,nj->n", arms, self.precision[np.maximum(at, 0)], arms)
        return np.where(at >= 0, np.exp(-0.5 * squares), 0.0)


def thinned(points):
    return points[:: max(1, len(points) // POINTS)]


def in_box_of(points, other, reach_m=1.0):
    return points[((points >= other.min(axis=0) - reach_m) & (points <= other.max(axis=0) + reach_m)).all(axis=1)]


def tree_of(points):
    from scipy.spatial import cKDTree  # here, so that all else runs without scipy
    return cKDTree(points)


def scores_of(a_m, b_m, tree_a, tree_b):
    """All baselines of one pair that need no free space, as a dict."""
    a_at, b_at = thinned(in_box_of(a_m, b_m)), thinned(in_box_of(b_m, a_m))
    if not len(a_at) or not len(b_at):
        return {}
    gaps = np.concatenate([tree_b.query(a_at)[0], tree_a.query(b_at)[0]])
    union = np.concatenate([a_m, b_m])
    tree = tree_of(union)
    scores = {}
    for d in RADII_M:
        near = gaps <= d
        scores[f"fitness {d}"] = 1.0 - near.mean()
        scores[f"rmse {d}"] = float(np.sqrt((gaps[near] ** 2).mean())) if near.any() else d
        scores[f"ndt {d}"] = -float(Cells(a_m, d).likelihood(b_at).mean())
        over_a, over_b = a_at[gaps[:len(a_at)] <= d], b_at[gaps[len(a_at):] <= d]
        at = np.concatenate([over_a, over_b])
        if not len(at):
            continue
        joint = entropies(union, tree, at, d)
        separate = np.concatenate([entropies(a_m, tree_a, over_a, d), entropies(b_m, tree_b, over_b, d)])
        both = np.isfinite(joint) & np.isfinite(separate)
        if both.any():
            scores[f"entropy {d}"] = float(joint[both].mean())
            scores[f"coral {d}"] = float((joint - separate)[both].mean())
            scores[f"coral separate {d}"] = float(separate[both].mean())
    return scores


def add(rows, truth, maps):
    """Adds `baselines` to every row. maps: the output folder of `kilter submaps`."""
    number = {submap["id"]: i for i, submap in enumerate(truth.submaps)}
    trees = [tree_of(places.voxels_m) for places in truth.places]
    for row in rows:
        a, b = number[row["target"]], number[row["source"]]
        row["baselines"] = scores_of(truth.places[a].voxels_m, truth.places[b].voxels_m, trees[a], trees[b])
    acceptance_index.add(rows, truth, maps)
