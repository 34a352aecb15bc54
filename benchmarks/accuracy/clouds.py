# SPDX-FileCopyrightText: The kilter authors
# SPDX-License-Identifier: BSD-3-Clause
"""Finished clouds out of a mission of scans: what somebody has who kept a map's pieces and not its scans.

Every piece is all points of the scans of some 10 m of path under the map's poses, one point for each cell of 5 cm, in
its first scan's frame. Nothing says from where a point was seen: no free space, no times, and what moved stays in.
Nothing here calls kilter.
"""
import numpy as np

import labels

PIECE_M = 10.0
CELL_M = 0.05


def cuts_of(positions):
    """(first, last) scan of each piece along a robot's path; a rest of less than half a piece goes with the one before."""
    path = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(positions, axis=0), axis=1))])
    pieces = max(1, int(path[-1] / PIECE_M + 0.5))
    starts = np.unique(np.searchsorted(path, PIECE_M * np.arange(pieces)))
    return list(zip(starts, [*(starts[1:] - 1), len(positions) - 1]))


def write_pcd(path, points):
    head = (f"VERSION .7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH {len(points)}\nHEIGHT 1\n"
            f"VIEWPOINT 0 0 0 1 0 0 0\nPOINTS {len(points)}\nDATA binary\n")
    path.write_bytes(head.encode("ascii") + points.astype("<f4").tobytes())


def write_mission(scans, folder, write_poses):
    """The mission `scans` as clouds in `folder`; {(robot, piece): (first scan, last scan)}."""
    cuts = {}
    for robot in sorted(path.name for path in scans.iterdir() if (path / "scans").is_dir()):
        rotations, positions = labels.read_poses(scans / robot / "poses.tum")
        files = sorted((scans / robot / "scans").iterdir())
        (folder / robot / "submaps").mkdir(parents=True, exist_ok=True)
        starts = []
        for piece, (first, last) in enumerate(cuts_of(positions)):
            R, t = rotations[first], positions[first]
            points = np.concatenate([(labels.read_scan(files[k]) @ rotations[k].T + positions[k] - t) @ R
                                     for k in range(first, last + 1)])
            _, kept = np.unique(np.floor(points / CELL_M).astype(np.int64), axis=0, return_index=True)
            write_pcd(folder / robot / "submaps" / f"{piece:04d}.pcd", points[np.sort(kept)])
            cuts[robot, piece] = int(first), int(last)
            starts.append(first)
        write_poses(folder / robot / "poses.tum", rotations[starts], positions[starts])
    return cuts
