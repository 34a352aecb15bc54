#!/usr/bin/env python3
# SPDX-FileCopyrightText: The kilter authors
# SPDX-License-Identifier: BSD-3-Clause
"""Draws a mission's map from above and one of its scans as a range image, and counts points per range.

    draw_scans.py MISSION [--poses DIR] [--robot a] [--scan 20] [-o PREFIX]

MISSION holds one folder per robot (scans/*.bin or *.pcd, poses.tum). Writes PREFIX-top.png and PREFIX-range.png, and
prints a table: share and count of points per ring of range, how far apart neighbours are there, and the noise of flat
patches (deviation of the points of a 0.4 m cell from their plane, where they are flat). Needs numpy, scipy, matplotlib.
"""
import argparse
import pathlib

import matplotlib
import numpy as np
from scipy.spatial import cKDTree

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402  (after the backend is chosen)

RINGS_M = [0, 2, 4, 6, 8, 10, 15, 20, 30, 50, 100]
COLOURS = ["tab:blue", "tab:red", "tab:green", "tab:orange", "tab:purple"]


PCD_KINDS = {"F": "f", "I": "i", "U": "u"}


def read_pcd(data):
    """Points of a PCD, ascii or binary, as an (n, 3) array."""
    head, mark, body = data.partition(b"\nDATA ")
    form, _, body = body.partition(b"\n")
    header = {words[0]: words[1:] for words in map(str.split, (head + mark).decode("ascii", "replace").splitlines()) if words}
    fields = header["FIELDS"]
    if form.strip() == b"ascii":
        rows = np.loadtxt(body.decode("ascii").splitlines(), ndmin=2)
        points = rows[:, [fields.index(axis) for axis in "xyz"]]
    else:
        kinds = [f"<{PCD_KINDS[kind]}{size}" for kind, size in zip(header["TYPE"], header["SIZE"])]
        rows = np.frombuffer(body, np.dtype(list(zip(fields, kinds))), count=int(header["POINTS"][0]))
        points = np.stack([rows[axis].astype(float) for axis in "xyz"], axis=1)
    return points


def read_points(path):
    """Points of a KITTI .bin, or of a PCD with one number a field, as an (n, 3) array."""
    data = path.read_bytes()
    points = np.frombuffer(data, "<f4").reshape(-1, 4)[:, :3].astype(float) if path.suffix == ".bin" else read_pcd(data)
    return points[np.isfinite(points).all(axis=1) & (points != 0.0).any(axis=1)]


def read_poses(path):
    """Rotation matrices (n, 3, 3) and translations (n, 3) from a TUM file."""
    rows = np.loadtxt(path, ndmin=2)
    x, y, z, w = rows[:, 4:8].T
    rotation = np.stack([1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w),
                         2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w),
                         2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)], axis=-1).reshape(-1, 3, 3)
    return rotation, rows[:, 1:4]


def robots_of(mission):
    return sorted(folder for folder in mission.iterdir() if (folder / "scans").is_dir())


def draw_top(mission, poses, out):
    figure, axes = plt.subplots(figsize=(11, 11))
    for number, robot in enumerate(robots_of(mission)):
        rotation, translation = read_poses(poses / robot.name / "poses.tum")
        scans = sorted((robot / "scans").iterdir())
        clouds = []
        for i in range(0, len(scans), max(1, len(scans) // 60)):
            points = read_points(scans[i])
            points = points[np.linalg.norm(points, axis=1) < 40.0]
            clouds.append(points[::5] @ rotation[i].T + translation[i])
        cloud = np.concatenate(clouds)
        # What lies between knee and head tells most about a plan.
        height = cloud[:, 2] - np.median(translation[:, 2])
        cloud = cloud[(height > -0.4) & (height < 1.2)]
        colour = COLOURS[number % len(COLOURS)]
        axes.scatter(cloud[:, 0], cloud[:, 1], s=0.15, c=colour, alpha=0.35, linewidths=0)
        axes.plot(translation[:, 0], translation[:, 1], c=colour, lw=1.2, label=robot.name)
        axes.plot(*translation[0, :2], "*", c=colour, ms=12)
    axes.set_aspect("equal")
    axes.legend(loc="upper right")
    figure.savefig(out, dpi=90, bbox_inches="tight")
    plt.close(figure)


def draw_range(points, out):
    distance = np.linalg.norm(points, axis=1)
    azimuth = np.degrees(np.arctan2(points[:, 1], points[:, 0]))
    elevation = np.degrees(np.arcsin(points[:, 2] / np.maximum(distance, 1e-9)))
    figure, axes = plt.subplots(figsize=(14, 4))
    dots = axes.scatter(-azimuth, elevation, s=1.5, c=np.log10(np.maximum(distance, 1e-9)), cmap="turbo",
                        vmin=0.0, vmax=np.log10(50.0), linewidths=0)
    bar = figure.colorbar(dots, ticks=np.log10([1, 2, 5, 10, 20, 50]))
    bar.ax.set_yticklabels(["1 m", "2", "5", "10", "20", "50"])
    axes.set_xlabel("azimuth, clockwise [deg]")
    axes.set_ylabel("elevation [deg]")
    axes.set_facecolor("black")
    figure.savefig(out, dpi=90, bbox_inches="tight")
    plt.close(figure)


def flat_noise(points):
    """Median deviation from the plane over flat, well filled 0.4 m cells within 15 m. [m]"""
    points = points[np.linalg.norm(points, axis=1) < 15.0]
    cells = np.floor(points / 0.4).astype(int)
    order = np.lexsort(cells.T)
    points, cells = points[order], cells[order]
    starts = np.flatnonzero(np.r_[True, (np.diff(cells, axis=0) != 0).any(axis=1)])
    deviations = []
    for group in np.split(points, starts[1:]):
        if len(group) < 12:
            continue
        values = np.linalg.eigvalsh(np.cov(group.T))
        if values[1] > 0.005 and values[0] < 0.05 * values[1]:  # not a single ring
            deviations.append(np.sqrt(values[0] * len(group) / (len(group) - 3.0)))
    return (np.median(deviations), len(deviations)) if deviations else (float("nan"), 0)


def print_table(clouds):
    """Mean over clouds: points per scan, and per ring of range its share and density on its sphere."""
    print(f"points per scan {np.mean([len(c) for c in clouds]):.0f}")
    print("range [m]    share   points per scan   nearest neighbour [mm]")
    distances = [np.linalg.norm(c, axis=1) for c in clouds]
    spacings = [cKDTree(c).query(c, k=2)[0][:, 1] for c in clouds]
    total = sum(len(d) for d in distances)
    for low, high in zip(RINGS_M, RINGS_M[1:]):
        count = sum(int(((d >= low) & (d < high)).sum()) for d in distances)
        spacing = np.concatenate([s[(d >= low) & (d < high)] for s, d in zip(spacings, distances)])
        apart = f"{1000 * np.median(spacing):.0f}" if len(spacing) else "-"
        print(f"{low:4d}-{high:<4d}   {count / total:7.3f}   {count / len(clouds):15.0f}   {apart:>22}")
    noise = [flat_noise(c) for c in clouds]
    print(f"noise on flat patches {1000 * np.nanmedian([n for n, _ in noise]):.1f} mm"
          f" ({np.mean([c for _, c in noise]):.0f} patches a scan)")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("mission", type=pathlib.Path)
    parser.add_argument("--poses", type=pathlib.Path)
    parser.add_argument("--robot", default="a")
    parser.add_argument("--scan", type=int, default=20)
    parser.add_argument("-o", "--out", default="scans")
    arguments = parser.parse_args()
    scans = sorted((arguments.mission / arguments.robot / "scans").iterdir())
    draw_top(arguments.mission, arguments.poses or arguments.mission, f"{arguments.out}-top.png")
    draw_range(read_points(scans[min(arguments.scan, len(scans) - 1)]), f"{arguments.out}-range.png")
    print_table([read_points(scan) for scan in scans[:: max(1, len(scans) // 10)]])


if __name__ == "__main__":
    main()
