# SPDX-FileCopyrightText: The kilter authors
# SPDX-License-Identifier: BSD-3-Clause
"""Damaged lists of poses: TUM, KITTI, tables with a heading, g2o."""

from __future__ import annotations

import struct
from collections.abc import Callable, Iterator

from .case import NO_REALS, Case
from .clouds import POINTS, pcd_parts
from .case import join

SCAN = b"".join(struct.pack("<4f", *p, 0.5) for p in POINTS)
CLOUD = join(pcd_parts("binary", b"".join(struct.pack("<3f", *p) for p in POINTS)))
SCANS = 3
Folder = Callable[[bytes], dict[str, bytes]]


def robot_folder(file: str) -> Folder:
    return lambda text: {file: text} | {f"scans/{i:06}.bin": SCAN for i in range(SCANS)}


def flat_folder(file: str) -> Folder:
    return lambda text: {file: text} | {f"{i:06}.pcd": CLOUD for i in range(SCANS)}


def text(rows: list[list[str]], separator: str = " ") -> bytes:
    return "".join(separator.join(row) + "\n" for row in rows).encode()


def damaged_rows(rows: list[list[str]], first: int, separator: str) -> Iterator[tuple[str, bytes]]:
    """`rows` of poses behind `first` lines or columns that are none; the second row is damaged."""
    start, pose, end = rows[:-2], rows[-2], rows[-1:]
    for word in NO_REALS:
        for column in (first, len(pose) - 1):
            if separator in word:
                continue  # which is a column more
            changed = [*pose[:column], word, *pose[column + 1:]]
            yield f"column_{column}_{word.replace('/', '_')}", text([*start, changed, *end], separator)
    yield "column_missing", text([*start, pose[:-1], *end], separator)
    yield "row_cut", text([*start, pose, end[0][:4]], separator)
    yield "row_missing", text([*start, *end], separator)
    yield "row_twice", text([*start, pose, pose, *end], separator)
    yield "no_rows", b""
    yield "only_comments", b"# t x y z\n# nothing\n"
    yield "zeros", bytes(400)
    yield "ones", b"\xff" * 400
    yield "far_away", text([*start, [*pose[:first], "1e9", *pose[first + 1:]], *end], separator)


def tum() -> Iterator[Case]:
    folder = robot_folder("poses.tum")
    rows = [[str(i), str(i), "0", "0", "0", "0", "0", "1"] for i in range(SCANS)]
    for name, content in damaged_rows(rows, 1, " "):
        yield Case("tum", name, folder(content))
    for name, quaternion in {"zeros": "0 0 0 0", "twice_too_long": "0 0 0 2", "half": "0.5 0 0 0", "nan": "nan 0 0 1"}.items():
        yield Case("tum", f"quaternion_{name}", folder(text([*rows[:2], [*rows[2][:4], *quaternion.split()]])))
    extra = [[*row, "9"] for row in rows]
    yield Case("tum", "column_more", folder(text(extra)))
    good = text(rows)
    for name, content in {"crlf": good.replace(b"\n", b"\r\n"), "byte_order_mark": b"\xef\xbb\xbf" + good, "blank_lines":
                          good.replace(b"\n", b"\n\n"), "comments": b"# t x y z qx qy qz qw\n" + good, "no_last_line_end": good[:-1],
                          "almost_unit": text([*rows[:2], [*rows[2][:4], "0", "0", "0", "1.004"]]),
                          "tabs": good.replace(b" ", b"\t"), "stamps_not_in_order": text(rows[::-1])}.items():
        yield Case("tum", name, folder(content), tolerated=True)


def kitti() -> Iterator[Case]:
    folder = robot_folder("poses.txt")
    rows = [f"1 0 0 {i} 0 1 0 0 0 0 1 0".split() for i in range(SCANS)]
    for name, content in damaged_rows(rows, 3, " "):
        yield Case("kitti", name, folder(content))
    for name, row in {"mirrored": "1 0 0 0 0 1 0 0 0 0 -1 0", "scaled": "2 0 0 0 0 2 0 0 0 0 2 0", "sheared": "1 0.5 0 0 0 1 0 0 0 0 1 0",
                      "zeros": " ".join(["0"] * 12), "sixteen": "1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1"}.items():
        yield Case("kitti", f"matrix_{name}", folder(text([*rows[:2], row.split()])))
    yield Case("kitti", "crlf", folder(text(rows).replace(b"\n", b"\r\n")), tolerated=True)
    yield Case("kitti", "rounded", folder(text([*rows[:2], "1.0001 0 0 2 0 0.9999 0 0 0 0 1 0".split()])), tolerated=True)


def table() -> Iterator[Case]:
    folder = flat_folder("trajectory.csv")
    heading = ["file", "t", "x", "y", "z", "qx", "qy", "qz", "qw"]
    rows = [[f"{i:06}.pcd", str(i), str(i), "0", "0", "0", "0", "0", "1"] for i in range(SCANS)]
    for name, content in damaged_rows([heading, *rows], 2, ","):
        if name == "row_missing":
            continue  # a cloud without a pose is left out and counted
        yield Case("table", name, folder(content))
    headings = {"twice_x": "file,t,x,x,z,qx,qy,qz,qw", "no_z": "file,t,x,y,w,qx,qy,qz,qw", "no_rotation": "file,t,x,y,z,a,b,c,d",
                "no_heading": "000009.pcd,9,9,0,0,0,0,0,1", "empty_cells": ",,,,,,,,"}
    for name, line in headings.items():
        yield Case("table", f"heading_{name}", folder(text([line.split(","), *rows], ",")))
    stray = [["../../../etc/passwd", *rows[0][1:]], *[[f"/dev/{i}", *row[1:]] for i, row in enumerate(rows[1:])]]
    yield Case("table", "names_of_files_elsewhere", folder(text([heading, *stray], ",")))
    long = [[*heading, *[f"c{i}" for i in range(100_000)]], *rows]
    yield Case("table", "hundred_thousand_columns", folder(text(long, ",")))
    good = text([heading, *rows], ",")
    for name, content in {"crlf": good.replace(b"\n", b"\r\n"), "byte_order_mark": b"\xef\xbb\xbf" + good,
                          "semicolons": good.replace(b",", b";"), "separator_at_the_end": good.replace(b"\n", b",\n")}.items():
        yield Case("table", name, folder(content), tolerated=True)


def g2o() -> Iterator[Case]:
    folder = flat_folder("graph.g2o")
    rows = [["VERTEX_SE3:QUAT", str(i), str(i), "0", "0", "0", "0", "0", "1"] for i in range(SCANS)]
    for name, content in damaged_rows(rows, 2, " "):
        if name == "row_missing":
            continue  # as above
        yield Case("g2o", name, folder(content))
    for word in ("-1", "1.5", "word", "99999999999999999999999"):
        yield Case("g2o", f"id_{word}", folder(text([rows[0], [rows[1][0], word, *rows[1][2:]], rows[2]])))
    yield Case("g2o", "quaternion_zeros", folder(text([*rows[:2], [*rows[2][:5], "0", "0", "0", "0"]])))
    yield Case("g2o", "planar", folder(b"VERTEX_SE2 0 0 0 0\nVERTEX_SE2 1 1 0 0\n"))
    yield Case("g2o", "edges_only", folder(b"EDGE_SE3:QUAT 0 1 1 0 0 0 0 0 1\n" * 5))
    good = text(rows)
    edge = b"EDGE_SE3:QUAT 0 77 nonsense\nFIX 0\nPARAMS_SE3OFFSET 0 0 0 0 0 0 0 1\n"
    for name, content in {"crlf": good.replace(b"\n", b"\r\n"), "byte_order_mark": b"\xef\xbb\xbf" + good, "other_lines": edge + good,
                          "not_in_order": text(rows[::-1])}.items():
        yield Case("g2o", name, folder(content), tolerated=True)


def cases() -> Iterator[Case]:
    for family in (tum, kitti, table, g2o):
        yield from family()
