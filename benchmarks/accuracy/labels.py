# SPDX-FileCopyrightText: The kilter authors
# SPDX-License-Identifier: BSD-3-Clause
"""What is true of the pairs of a simulated mission, from its truth alone.

Nothing here calls kilter or links it: the scans, the poses of the map and the true poses are read again, and only the
cuts (which scan belongs to which submap) are taken from a result.

A *place* is a cell of 0.3 m in the true world that a submap's beams hit. The map puts what a submap saw of it
somewhere else: by the mean, over its points in the cell, of (position in the map - true position). Over the places
that two submaps both hit, the difference of the two is their *disagreement*; its RMS is what kilter has to find.
A small yaw at long range and a bend inside a submap so count as what they are.
"""
import json
import pathlib

import numpy as np

CELL_M = 0.3
VOXEL_M = 0.1
LEAST_CELLS = 60
LEAST_SHARE = 0.02  # of the information, for a direction to count as fixed by the scene
MAX_RANGE_M = 60.0


def read_poses(path):
    """Rotations (n, 3, 3) and translations (n, 3) of a TUM file."""
    rows = np.loadtxt(path, ndmin=2)
    x, y, z, w = (rows[:, 4:8] / np.linalg.norm(rows[:, 4:8], axis=1, keepdims=True)).T
    rotations = np.array([[1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
                          [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
                          [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)]]).transpose(2, 0, 1)
    return rotations, rows[:, 1:4]


def read_pcd(path):
    """Positions of an ascii or binary PCD file whose x, y and z are 4-byte floats (n, 3)."""
    data = path.read_bytes()
    head, start = {}, 0
    while "DATA" not in head:
        end = data.index(b"\n", start)
        words = data[start:end].decode("ascii").split()
        start = end + 1
        if words and not words[0].startswith("#"):
            head[words[0]] = words[1:]
    count = int(head["POINTS"][0])
    repeats = [int(word) for word in head.get("COUNT", ["1"] * len(head["FIELDS"]))]
    if head["DATA"][0] == "ascii":
        rows = np.array(data[start:].split(), dtype=float).reshape(count, sum(repeats))
        first = np.cumsum([0, *repeats])
        return rows[:, [first[head["FIELDS"].index(axis)] for axis in "xyz"]]
    sizes = [int(size) * n for size, n in zip(head["SIZE"], repeats)]
    offsets = np.cumsum([0, *sizes])
    layout = np.dtype({"names": list("xyz"), "formats": ["<f4"] * 3, "itemsize": int(offsets[-1]),
                       "offsets": [int(offsets[head["FIELDS"].index(axis)]) for axis in "xyz"]})
    records = np.frombuffer(data, layout, count, start)
    return np.stack([records[axis] for axis in "xyz"], axis=1).astype(float)


def read_scan(path):
    if path.suffix == ".pcd":
        points = read_pcd(path)
        points = points[np.isfinite(points).all(axis=1)]
    else:
        points = np.fromfile(path, "<f4").reshape(-1, 4)[:, :3].astype(float)
    ranges = np.linalg.norm(points, axis=1)
    return points[(ranges > 0.5) & (ranges < MAX_RANGE_M)]


def keys_of(points_m):
    cells = np.floor(points_m / CELL_M).astype(np.int64) + (1 << 20)
    return (cells[:, 2] << 42) | (cells[:, 1] << 21) | cells[:, 0]


def centres_of(keys):
    mask = (1 << 21) - 1
    cells = np.stack([keys & mask, (keys >> 21) & mask, keys >> 42], axis=1) - (1 << 20)
    return (cells + 0.5) * CELL_M


class Places:
    """The cells that one submap hit: sorted keys and, for each, the mean displacement of the map from the truth. Also the
    cells that it hits where the map has it, and its voxels of 0.1 m there, for the baselines."""

    def __init__(self, true_m, map_m):
        self.map_keys = np.unique(keys_of(map_m))
        self.voxels_m = (np.unique(np.floor(map_m / VOXEL_M).astype(np.int64), axis=0) + 0.5) * VOXEL_M
        self.keys, inverse, self.counts = np.unique(keys_of(true_m), return_inverse=True, return_counts=True)
        shift = map_m - true_m
        self.shift_m = np.stack([np.bincount(inverse, shift[:, k]) for k in range(3)], axis=1) / self.counts[:, None]


class World:
    """First and second moments of all true points per cell, for normals."""

    def __init__(self, true_m):
        self.keys, inverse = np.unique(keys_of(true_m), return_inverse=True)
        columns = [np.ones(len(true_m)), *true_m.T]
        columns += [true_m[:, a] * true_m[:, b] for a, b in ((0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2))]
        self.moments = np.stack([np.bincount(inverse, column) for column in columns], axis=1)

    def normals(self, keys):
        """Unit normals and planarity (0..1) from the 27 cells around each."""
        sums = np.zeros((len(keys), 10))
        for dz in (-1, 0, 1):
            for dy in (-1, 0, 1):
                for dx in (-1, 0, 1):
                    near = keys + (dz << 42) + (dy << 21) + dx
                    at = np.minimum(np.searchsorted(self.keys, near), len(self.keys) - 1)
                    found = self.keys[at] == near
                    sums[found] += self.moments[at[found]]
        n = np.maximum(sums[:, 0], 1.0)
        mean = sums[:, 1:4] / n[:, None]
        second = sums[:, 4:10] / n[:, None]
        covariance = np.empty((len(keys), 3, 3))
        for k, (a, b) in enumerate(((0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2))):
            covariance[:, a, b] = covariance[:, b, a] = second[:, k] - mean[:, a] * mean[:, b]
        values, vectors = np.linalg.eigh(covariance)
        spread = np.sqrt(np.maximum(values, 0.0))
        planarity = (spread[:, 1] - spread[:, 0]) / np.maximum(spread[:, 2], 1e-9)
        return vectors[:, :, 0], np.where(n >= 8, planarity, 0.0)


def rigid_fit(source, target):
    """R, t that bring source points onto target points (Kabsch)."""
    cs, ct = source.mean(axis=0), target.mean(axis=0)
    u, _, vt = np.linalg.svd((source - cs).T @ (target - ct))
    d = np.sign(np.linalg.det(vt.T @ u.T))
    rotation = vt.T @ np.diag([1.0, 1.0, d]) @ u.T
    return rotation, ct - rotation @ cs


def fixed_directions(points_m, normals, weights):
    """(projector on what the scene fixes in scaled (v, w), centre, scaling): rotation times RMS distance, so lengths."""
    centre = np.average(points_m, axis=0, weights=weights)
    arms = points_m - centre
    values, axes = np.linalg.eigh((arms * weights[:, None]).T @ arms / weights.sum())
    radii = np.sqrt(np.maximum(values.sum() - values, 1e-6))
    unscale = np.zeros((6, 6))
    unscale[:3, :3] = axes
    unscale[3:, 3:] = axes / radii
    jacobian = np.hstack([normals, np.cross(arms, normals)]) @ unscale
    shares, vectors = np.linalg.eigh((jacobian * weights[:, None]).T @ jacobian / weights.sum())
    fixed = vectors[:, shares >= LEAST_SHARE]
    return fixed @ fixed.T, centre, unscale, shares


def quaternion_of(R):
    """x, y, z, w of a rotation matrix."""
    four = np.array([[R[0, 0] - R[1, 1] - R[2, 2], 0, 0, 0],
                     [R[1, 0] + R[0, 1], R[1, 1] - R[0, 0] - R[2, 2], 0, 0],
                     [R[2, 0] + R[0, 2], R[2, 1] + R[1, 2], R[2, 2] - R[0, 0] - R[1, 1], 0],
                     [R[2, 1] - R[1, 2], R[0, 2] - R[2, 0], R[1, 0] - R[0, 1], np.trace(R)]]) / 3.0
    _, vectors = np.linalg.eigh(four, UPLO="L")  # the largest eigenvalue's vector
    q = vectors[:, -1]
    return q if q[3] >= 0 else -q


def to_matrix(pose):
    x, y, z, qx, qy, qz, qw = pose
    T = np.eye(4)
    T[:3, :3] = [[1 - 2 * (qy * qy + qz * qz), 2 * (qx * qy - qz * qw), 2 * (qx * qz + qy * qw)],
                 [2 * (qx * qy + qz * qw), 1 - 2 * (qx * qx + qz * qz), 2 * (qy * qz - qx * qw)],
                 [2 * (qx * qz - qy * qw), 2 * (qy * qz + qx * qw), 1 - 2 * (qx * qx + qy * qy)]]
    T[:3, 3] = [x, y, z]
    return T


def kind_of(source, target):
    if source["robot"] != target["robot"]:
        return "global"
    gap = source["index"] - target["index"]
    return "sequential" if gap == 1 else "local"


class Truth:
    """All that the truth says of one result's submaps and pairs."""

    def __init__(self, mission, truth, poses, submaps):
        """poses: the folder whose ROBOT/poses.tum drew the map (the mission itself, or other poses for its scans)."""
        self.submaps = submaps
        self.frames = [to_matrix(s["T_world_submap"]) for s in submaps]
        self.places = []
        self.world = None
        every = []
        for submap in submaps:
            robot = submap["robot"]
            scans = sorted((mission / robot / "scans").iterdir())
            true_R, true_t = read_poses(truth / robot / "poses.tum")
            map_R, map_t = read_poses(poses / robot / "poses.tum")
            trues, maps = [], []
            for k in range(submap["first_scan"], submap["last_scan"] + 1):
                points = read_scan(scans[k])
                trues.append(points @ true_R[k].T + true_t[k])
                maps.append(points @ map_R[k].T + map_t[k])
            true_m = np.concatenate(trues)
            self.places.append(Places(true_m, np.concatenate(maps)))
            every.append(true_m[::3])
        self.world = World(np.concatenate(every))

    def pairs(self, least_overlap=0.15):
        """Every pair that truly sees common places, as dicts."""
        for s, source in enumerate(self.submaps):
            for t in range(s):
                label = self.pair(s, t)
                if label and label["overlap"] >= least_overlap:
                    yield label

    def wrong_places(self, least_overlap=0.3):
        """Pairs that overlap in the map although they saw next to nothing in common."""
        for s, source in enumerate(self.submaps):
            for t in range(s):
                a, b = self.places[t], self.places[s]
                in_map = len(np.intersect1d(a.map_keys, b.map_keys, assume_unique=True))
                overlap = in_map / min(len(a.map_keys), len(b.map_keys))
                if overlap < least_overlap:
                    continue
                if len(np.intersect1d(a.keys, b.keys, assume_unique=True)) < LEAST_CELLS:
                    yield {"source": source["id"], "target": self.submaps[t]["id"], "map_overlap": overlap}

    def apart_by_pose(self, s, t):
        """RMS over the source's places of how far they lie from where the target's rigid motion (truth to map) would have
        put them: how far off a pair is that has no places in common."""
        a, b = self.places[t], self.places[s]
        true_a, true_b = centres_of(a.keys), centres_of(b.keys)
        R, shift = rigid_fit(true_a, true_a + a.shift_m)
        return float(np.sqrt((np.linalg.norm(true_b @ R.T + shift - (true_b + b.shift_m), axis=1)**2).mean()))

    def pair(self, s, t):
        a, b = self.places[t], self.places[s]
        common, ia, ib = np.intersect1d(a.keys, b.keys, assume_unique=True, return_indices=True)
        if len(common) < LEAST_CELLS:
            return None
        centres = centres_of(common)
        at_a = centres + a.shift_m[ia]
        at_b = centres + b.shift_m[ib]
        apart = np.linalg.norm(at_b - at_a, axis=1)
        in_a = (at_a - self.frames[t][:3, 3]) @ self.frames[t][:3, :3]
        in_b = (at_b - self.frames[s][:3, 3]) @ self.frames[s][:3, :3]
        R, shift = rigid_fit(in_b, in_a)
        bend = np.linalg.norm(in_b @ R.T + shift - in_a, axis=1)
        normals, weights = self.world.normals(common)
        weights = weights + 1e-6
        fixed, centre, unscale, shares = fixed_directions(in_a, normals @ self.frames[t][:3, :3], weights)
        return {"source": self.submaps[s]["id"], "target": self.submaps[t]["id"],
                "kind": kind_of(self.submaps[s], self.submaps[t]),
                "overlap": len(common) / min(len(a.keys), len(b.keys)), "cells": len(common),
                "rms_m": float(np.sqrt((apart**2).mean())), "p95_m": float(np.percentile(apart, 95)),
                "bend_m": float(np.sqrt((bend**2).mean())), "R": R, "t": shift, "in_b": in_b, "in_a": in_a,
                "fixed": fixed, "centre": centre, "unscale": unscale, "shares": shares}


def pose_error(label, T):
    """(RMS displacement in the directions that the scene fixes, in all directions, angle) of T_target_source against
    the truth over the common places, and the error as (v, w) about their centre, target axes."""
    T_true = np.eye(4)
    T_true[:3, :3], T_true[:3, 3] = label["R"], label["t"]
    E = T @ np.linalg.inv(T_true)
    angle = np.arccos(np.clip((np.trace(E[:3, :3]) - 1) / 2, -1, 1))
    axis = np.array([E[2, 1] - E[1, 2], E[0, 2] - E[2, 0], E[1, 0] - E[0, 1]])
    w = axis / np.linalg.norm(axis) * angle if np.linalg.norm(axis) > 1e-12 else np.zeros(3)
    centre = label["centre"]
    x = np.concatenate([E[:3, :3] @ centre + E[:3, 3] - centre, w])
    scaled = np.linalg.solve(label["unscale"], x)
    return float(np.linalg.norm(label["fixed"] @ scaled)), float(np.linalg.norm(scaled)), float(np.degrees(angle)), x


def load(mission_dir, result, poses=None):
    """Truth of a folder written by `kilter simulate`, for a result.json (parsed) of its mission."""
    root = pathlib.Path(mission_dir)
    return Truth(root / "mission", root / "truth", pathlib.Path(poses) if poses else root / "mission", result["submaps"])


def read_result(folder):
    return json.loads((pathlib.Path(folder) / "result.json").read_text(encoding="utf-8"))


def is_constraint(pair):
    """Whether check hands a pair's registration on in constraints.g2o: decided, by it."""
    return (pair["verdict"] != "unverified" and pair["T_target_source_registered"] is not None
            and not without_registration(pair))


def is_rigid(pair, tolerance_m):
    """Whether one rigid motion mends a pair: where not, its covariance is that of bodies bent by so much."""
    return ((pair["evidence"].get("bend_m") or {}).get("value") or 0.0) <= tolerance_m


# Evidence that has a log ratio only where it decides without a registration that is believed: free space alone, a pose that
# fits better, neighbours.
WITNESSES = ("conflict", "support", "agreeing")


def without_registration(pair):
    """Whether a pair of result.json was judged by one of the WITNESSES: no registration of it is believed."""
    return any(pair["evidence"].get(name, {}).get("log_ratio") is not None for name in WITNESSES)
