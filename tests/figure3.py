#!/usr/bin/env python3
# SPDX-FileCopyrightText: The kilter authors
# SPDX-License-Identifier: BSD-3-Clause
"""The paper's Figure 3: two straight lines that meet at an angle, and the histogram of their distances.

    tests/figure3.py        writes docs/figure3.svg from what build/kilter says (paper_test.py compares)
"""

from __future__ import annotations

import json
import math
import tempfile
from pathlib import Path

from kilter_runner import SOURCE_DIR, run_kilter

PICTURE = SOURCE_DIR / "docs" / "figure3.svg"
D = 1.0  # maximum search distance, the paper's d. [m]


def lines() -> tuple[list, list]:
    """Points of both lines [m], from their common start to where they are d apart."""
    angle = math.asin(0.1)
    along = [(0.01 * i + 0.004, 0.0051, 0.0051) for i in range(1100)]
    tilted = [(s * math.cos(angle), 0.0051 + s * math.sin(angle), 0.0051) for s in (0.005 * i for i in range(1999))]
    return along, tilted


def draw(pair: dict) -> str:
    """An SVG of the two lines and of the pair's histogram with the law fitted to it (Eq. 12)."""
    width, height, left, base = 640, 300, 330, 250
    counts = pair["histogram"]["counts"]
    bins = [sum(counts[i:i + 5]) for i in range(0, len(counts), 5)]
    top = 2.0 * pair["matched"] / len(bins)
    step = 280.0 / len(bins)
    parts = [f'<svg xmlns="http://www.w3.org/2000/svg" width="{width}" height="{height}" '
             f'viewBox="0 0 {width} {height}" font-family="sans-serif" font-size="12">',
             f'<rect width="{width}" height="{height}" fill="#ffffff"/>',
             f'<line x1="20" y1="{base}" x2="290" y2="{base}" stroke="#1f5fa8" stroke-width="3"/>',
             f'<line x1="20" y1="{base}" x2="270" y2="90" stroke="#c8501e" stroke-width="3"/>',
             f'<text x="20" y="{base + 20}">target</text>', '<text x="60" y="85">source (angle not to scale)</text>',
             f'<text x="{left}" y="30">distances on [0, d], d = 1 m</text>']
    for i, count in enumerate(bins):
        bar = 180.0 * count / top
        parts.append(f'<rect x="{left + i * step:.1f}" y="{base - bar:.1f}" width="{step - 1:.1f}" height="{bar:.1f}" '
                     'fill="#b8c4d2"/>')
    mass = 0.5 * (math.erf((D - pair["mu"]) / pair["sigma"] / math.sqrt(2)) + math.erf(pair["mu"] / pair["sigma"] / math.sqrt(2)))
    points = []
    for i in range(101):
        x = 0.01 * i * D
        z = (x - pair["mu"]) / pair["sigma"]
        density = math.exp(-0.5 * z * z) / (pair["sigma"] * math.sqrt(2 * math.pi) * mass)
        points.append(f"{left + 2.8 * i:.1f},{base - 180.0 * density * pair['matched'] * D / len(bins) / top:.1f}")
    parts.append(f'<polyline points="{" ".join(points)}" fill="none" stroke="#111111" stroke-width="2"/>')
    parts.append(f'<text x="{left}" y="{base + 20}">parent mu = {pair["mu"]:.3f} m, sigma\u00b2 = {pair["sigma"] ** 2:.4f} m\u00b2</text>')
    parts.append(f'<text x="{left}" y="{base + 38}">truncated mu = {pair["mu_t"]:.3f} m, sigma\u00b2 = {pair["var_t"]:.4f} m\u00b2</text>')
    return "\n".join(parts) + "\n</svg>\n"


def cloud(points: list) -> str:
    """The points as an ascii PCD file."""
    head = (f"VERSION 0.7\nFIELDS x y z\nSIZE 8 8 8\nTYPE F F F\nCOUNT 1 1 1\nWIDTH {len(points)}\nHEIGHT 1\n"
            f"VIEWPOINT 0 0 0 1 0 0 0\nPOINTS {len(points)}\nDATA ascii\n")
    return head + "".join(f"{x!r} {y!r} {z!r}\n" for x, y, z in points)


def main() -> None:
    with tempfile.TemporaryDirectory(prefix="kilter_figure3_") as name:
        folder = Path(name)
        for robot, points in zip("ab", lines()):
            (folder / robot / "submaps").mkdir(parents=True)
            (folder / robot / "submaps" / "000000.pcd").write_text(cloud(points))
            (folder / robot / "poses.tum").write_text("0 0 0 0 0 0 0 1\n")
        run_kilter("check", folder, "--set", "resolution=0.01", "-o", folder / "out")
        result = json.loads((folder / "out" / "result.json").read_text())
    PICTURE.write_text(draw(result["pairs"][0]), encoding="utf-8")


if __name__ == "__main__":
    main()
