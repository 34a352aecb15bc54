#!/usr/bin/env python3
# SPDX-FileCopyrightText: The kilter authors
# SPDX-License-Identifier: BSD-3-Clause
"""Writes a small two-robot mission with one planted fault, from the standard library alone.

make_tiny_mission.py DIR    DIR/mission/{a,b}: scans (KITTI .bin) and poses.tum as a mapper might have left them
                            DIR/truth/{a,b}/poses.tum: where the scans were really taken

Two robots cross a furnished hall, a eastward and b back westward. From b's scan FAULT_FROM on its poses lie FAULT_M
to the north of the truth, as after a wrong loop closure, so what b saw from there on stands in the map twice.
Lengths in metres, frames as in docs/frames.md; the same bytes on every run.
"""

from __future__ import annotations

import math
import random
import struct
import sys
from dataclasses import dataclass
from pathlib import Path

SCANS, STEP_M = 13, 2.0
FAULT_FROM, FAULT_M = 5, 0.4
RINGS, LOWEST_RAD, HIGHEST_RAD = 32, math.radians(-28.0), math.radians(22.0)
AZIMUTHS = 480
SENSOR_HEIGHT_M, NOISE_M = 1.2, 0.01


@dataclass(frozen=True)
class Box:
    """An upright block between two corners of the floor plan, standing on the floor."""

    x0: float
    y0: float
    x1: float
    y1: float
    height: float

    def crossed(self, x: float, y: float, dx: float, dy: float) -> tuple[float, float] | None:
        """Horizontal distances at which the ray from (x, y) enters and leaves the floor plan; None if it misses."""
        near, far = -math.inf, math.inf
        for start, step, low, high in ((x, dx, self.x0, self.x1), (y, dy, self.y0, self.y1)):
            if abs(step) < 1e-12:
                if not low <= start <= high:
                    return None
                continue
            first, second = sorted(((low - start) / step, (high - start) / step))
            near, far = max(near, first), min(far, second)
        return (near, far) if near <= far and far > 0.0 else None


HALL = Box(0.0, 0.0, 30.0, 12.0, 4.0)
FURNITURE = (
    Box(4.0, 0.0, 4.3, 2.5, 4.0),      # stubs of walls along the south side, unevenly spaced
    Box(11.0, 0.0, 11.3, 1.8, 4.0),
    Box(19.5, 0.0, 19.8, 2.9, 4.0),
    Box(7.5, 10.2, 7.8, 12.0, 4.0),    # and along the north side
    Box(16.0, 9.8, 16.3, 12.0, 4.0),
    Box(23.6, 10.4, 23.9, 12.0, 4.0),
    Box(9.0, 5.6, 9.6, 6.2, 4.0),      # columns
    Box(15.2, 5.7, 15.8, 6.3, 4.0),
    Box(21.8, 5.5, 22.4, 6.1, 4.0),
    Box(12.4, 5.4, 13.6, 6.6, 0.8),    # crates
    Box(25.0, 1.0, 26.5, 2.2, 1.4),
    Box(2.0, 9.6, 3.2, 11.0, 1.0),
    Box(27.6, 9.0, 28.6, 10.6, 1.9),
)


@dataclass(frozen=True)
class Pose:
    """T_world_sensor of an upright sensor."""

    x: float
    y: float
    yaw: float

    def tum(self, stamp_s: float) -> str:
        half = 0.5 * self.yaw
        numbers = (stamp_s, self.x, self.y, SENSOR_HEIGHT_M, 0.0, 0.0, math.sin(half), math.cos(half))
        return " ".join(f"{number:.9f}" for number in numbers)


def range_of(slope: float, blocks: list[tuple[float, float, float]], wall_m: float) -> float:
    """Horizontal distance to the first surface along a ray that rises by `slope` per metre.

    `blocks` are (enter, leave, height) of the furniture on the way, nearest first; `wall_m` is the distance of the
    hall's wall, behind which nothing is seen.
    """
    for enter, leave, height in blocks:
        if SENSOR_HEIGHT_M + slope * enter <= height:
            if SENSOR_HEIGHT_M + slope * enter >= 0.0:
                return enter  # a side
            break  # the floor comes first
        if SENSOR_HEIGHT_M + slope * leave <= height:
            return (height - SENSOR_HEIGHT_M) / slope  # a top
    if slope < 0.0:
        return min(wall_m, -SENSOR_HEIGHT_M / slope)
    return min(wall_m, (HALL.height - SENSOR_HEIGHT_M) / slope) if slope > 0.0 else wall_m


def scan(pose: Pose, noise: random.Random) -> bytes:
    """One turn of the lidar in its own frame: float32 x y z intensity per point."""
    points = bytearray()
    for k in range(AZIMUTHS):
        azimuth = 2.0 * math.pi * k / AZIMUTHS
        dx, dy = math.cos(azimuth + pose.yaw), math.sin(azimuth + pose.yaw)
        crossings = ((box.crossed(pose.x, pose.y, dx, dy), box.height) for box in FURNITURE)
        blocks = sorted((*crossing, height) for crossing, height in crossings if crossing)
        wall_m = HALL.crossed(pose.x, pose.y, dx, dy)[1]
        for ring in range(RINGS):
            elevation = LOWEST_RAD + (HIGHEST_RAD - LOWEST_RAD) * ring / (RINGS - 1)
            exact_m = range_of(math.tan(elevation), blocks, wall_m) / math.cos(elevation)
            range_m = exact_m + noise.gauss(0.0, NOISE_M)
            flat_m = range_m * math.cos(elevation)
            points += struct.pack("<4f", flat_m * math.cos(azimuth), flat_m * math.sin(azimuth),
                                  range_m * math.sin(elevation), 0.5)
    return bytes(points)


def drives() -> dict[str, list[Pose]]:
    """True poses of both robots; each sways a little so that no two scans look along the same lines."""
    def sway(i: int) -> float:
        return 0.15 * math.sin(1.3 * i)

    return {
        "a": [Pose(3.0 + STEP_M * i, 3.6 + sway(i), 0.1 * sway(i)) for i in range(SCANS)],
        "b": [Pose(27.0 - STEP_M * i, 8.2 + sway(i + 5), math.pi + 0.1 * sway(i)) for i in range(SCANS)],
    }


def with_fault(robot: str, poses: list[Pose]) -> list[Pose]:
    """The poses as the map has them."""
    if robot != "b":
        return poses
    return poses[:FAULT_FROM] + [Pose(pose.x, pose.y + FAULT_M, pose.yaw) for pose in poses[FAULT_FROM:]]


def write_poses(folder: Path, poses: list[Pose]) -> None:
    folder.mkdir(parents=True, exist_ok=True)
    lines = (pose.tum(float(i)) + "\n" for i, pose in enumerate(poses))
    (folder / "poses.tum").write_text("".join(lines), encoding="ascii")


def write(root: Path) -> None:
    """Writes mission and truth under `root`; what was there under the same names is replaced."""
    noise = random.Random(1)
    for robot, truth in drives().items():
        write_poses(root / "truth" / robot, truth)
        write_poses(root / "mission" / robot, with_fault(robot, truth))
        scans = root / "mission" / robot / "scans"
        scans.mkdir(exist_ok=True)
        for i, pose in enumerate(truth):
            (scans / f"{i:06d}.bin").write_bytes(scan(pose, noise))


def main() -> int:
    if len(sys.argv) != 2:
        print("usage: make_tiny_mission.py DIR", file=sys.stderr)
        return 2
    write(Path(sys.argv[1]))
    return 0


if __name__ == "__main__":
    sys.exit(main())
