# SPDX-FileCopyrightText: The kilter authors
# SPDX-License-Identifier: BSD-3-Clause
"""ROC curves as a picture."""
import numpy as np

import scores
import tables

COLOURS = ("#1f5fa8", "#c8501e", "#3a7d44", "#7a4fa3", "#8a6d1d", "#5b6770", "#b0357a", "#2a8c8c", "#94622e", "#404040",
           "#d98c00", "#1c2a6b", "#7db52e")


def corners(points):
    """Of a staircase's points, as they are printed, those at which it turns."""
    kept = []
    for point in points:
        if kept and point == kept[-1]:
            continue
        if len(kept) > 1 and any(kept[-2][axis] == kept[-1][axis] == point[axis] for axis in (0, 1)):
            kept.pop()
        kept.append(point)
    return [",".join(point) for point in kept]


def draw(answers):
    """SVG: ROC curves of all scores over the pairs whose pose the scene fixes; the false positive axis is logarithmic."""
    bad, good = tables.select(answers, tables.BAD_M, tables.GOOD_M)
    left, top, width, height = 70, 30, 420, 360
    lowest = 1e-3

    def x_of(false):
        return left + width * (np.log10(np.maximum(false, lowest)) - np.log10(lowest)) / -np.log10(lowest)

    parts = ['<svg xmlns="http://www.w3.org/2000/svg" width="860" height="460" viewBox="0 0 860 460" '
             'font-family="sans-serif" font-size="12">', '<rect width="860" height="460" fill="#ffffff"/>']
    for false in (0.001, 0.01, 0.1, 1.0):
        x = x_of(np.array(false))
        parts.append(f'<line x1="{x:.1f}" y1="{top}" x2="{x:.1f}" y2="{top + height}" stroke="#dddddd"/>'
                     f'<text x="{x:.1f}" y="{top + height + 18}" text-anchor="middle">{false:g}</text>')
    for true in (0.0, 0.25, 0.5, 0.75, 1.0):
        y = top + height * (1 - true)
        parts.append(f'<line x1="{left}" y1="{y:.1f}" x2="{left + width}" y2="{y:.1f}" stroke="#dddddd"/>'
                     f'<text x="{left - 8}" y="{y + 4:.1f}" text-anchor="end">{true:g}</text>')
    parts.append(f'<text x="{left + width / 2}" y="{top + height + 40}" text-anchor="middle">share of good pairs called bad</text>')
    parts.append(f'<text x="20" y="{top + height / 2}" text-anchor="middle" transform="rotate(-90 20 {top + height / 2})">'
                 'share of bad pairs found</text>')
    for k, (name, score) in enumerate(tables.methods(answers).items()):
        false, true = scores.curve(np.array([score(r) for r in bad]), np.array([score(r) for r in good]))
        colour = COLOURS[k % len(COLOURS)]
        points = " ".join(corners([(f"{x:.1f}", f"{top + height * (1 - y):.1f}") for x, y in zip(x_of(false), true)]))
        parts.append(f'<polyline points="{points}" fill="none" stroke="{colour}" stroke-width="{2.5 if k == 0 else 1.5}"/>')
        y = top + 14 + 22 * k
        parts.append(f'<line x1="510" y1="{y - 4}" x2="535" y2="{y - 4}" stroke="{colour}" stroke-width="3"/>'
                     f'<text x="542" y="{y}">{name}: {tables.area_of(answers, score):.3f}</text>')
    return "\n".join(parts) + "\n</svg>\n"
