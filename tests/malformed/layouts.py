# SPDX-FileCopyrightText: The kilter authors
# SPDX-License-Identifier: BSD-3-Clause
"""Damaged folders as GLIM, hdl_graph_slam, KISS-SLAM, LT-mapper and KITTI's tools leave them."""

from __future__ import annotations

import struct
from collections.abc import Iterator

from .case import Case, seeds
from .clouds import POINTS
from .poses import CLOUD, SCAN

LITTLE = b"".join(struct.pack("<3f", *p) for p in POINTS)
GOOD = "0 -1 0 1\n1 0 0 2\n0 0 1 3\n0 0 0 1\n"
# What stands in the place of a 4x4 matrix.
NO_MATRICES = {"word": GOOD.replace("2", "two", 1), "nan": GOOD.replace("3", "nan"), "three_rows": "".join(GOOD.splitlines(True)[:3]),
               "three_columns": "0 -1 0\n1 0 0\n0 0 1\n0 0 0\n", "zeros": "0 0 0 0\n" * 4, "last_row": GOOD[:-2] + "7\n",
               "mirrored": GOOD.replace("0 0 1 3", "0 0 -1 3"), "scaled": GOOD.replace("-1", "-3"), "far": GOOD.replace("1 0 0 2", "1 0 0 1e12"),
               "nothing": ""}


def two_folders(text_name: str, texts: tuple[str, str], cloud_name: str, clouds: tuple[bytes | None, bytes | None]) -> dict[str, bytes]:
    """000000/ and 000001/, each with a text and a cloud, or without the cloud."""
    files = {}
    for i in range(2):
        files[f"{i:06}/{text_name}"] = texts[i].encode()
        cloud = clouds[i]
        if cloud is not None:
            files[f"{i:06}/{cloud_name}"] = cloud
    return files


def glim(text: str | None = None, points: bytes | None = LITTLE, graph: str = "num_submaps: 2\nnum_all_frames: 2\n") -> dict[str, bytes]:
    good = f"gid: 0\nT_world_origin: \n{GOOD}num_frames: 1\nframe_0\nid: 0\nstamp: 12.5\n"
    second = good if text is None else text
    return {"graph.txt": graph.encode()} | two_folders("data.txt", (good, second), "points_compact.bin", (LITTLE, points))


def glim_cases() -> Iterator[Case]:
    for name, matrix in NO_MATRICES.items():
        yield Case("glim", f"pose_{name}", glim(f"gid: 1\nT_world_origin: \n{matrix}num_frames: 1\n"))
    for name, text in {"no_pose": "gid: 1\n", "empty": "", "zeros": "\0" * 500}.items():
        yield Case("glim", f"data_{name}", glim(text))
    for name, points in {"empty": b"", "one_byte_less": LITTLE[:-1], "one_byte_more": LITTLE + b"\0", "missing": None}.items():
        yield Case("glim", f"points_{name}", glim(points=points))
    yield Case("glim", "points_not_finite", glim(points=struct.pack("<3f", *[float("nan")] * 3) * 4), tolerated=True)
    yield Case("glim", "one_submap_less_than_said", glim(graph="num_submaps: 3\n"), tolerated=True)
    yield Case("glim", "stamp_a_word", glim(f"T_world_origin: \n{GOOD}stamp: never\n"), tolerated=True)


def hdl(text: str | None = None, cloud: bytes | None = CLOUD) -> dict[str, bytes]:
    good = f"stamp 1503043136 87654\nestimate\n{GOOD}odom\n{GOOD}accum_distance 3.5\nid 4\n"
    return two_folders("data", (good, good if text is None else text), "cloud.pcd", (CLOUD, cloud))


def hdl_cases() -> Iterator[Case]:
    for name, matrix in NO_MATRICES.items():
        yield Case("hdl", f"estimate_{name}", hdl(f"stamp 1 2\nestimate\n{matrix}odom\n{GOOD}id 5\n"))
    for name, text in {"no_pose": "stamp 1 2\nid 5\n", "empty": "", "zeros": "\0" * 500}.items():
        yield Case("hdl", f"data_{name}", hdl(text))
    for name, cloud in {"missing": None, "empty": b"", "cut": CLOUD[:-1], "header_only": CLOUD[:60]}.items():
        yield Case("hdl", f"cloud_{name}", hdl(cloud=cloud))
    yield Case("hdl", "stamp_a_word", hdl(f"stamp when ever\nestimate\n{GOOD}"), tolerated=True)
    yield Case("hdl", "only_odometry", hdl(f"stamp 1 2\nodom\n{GOOD}id 5\n"), tolerated=True)


MAP = seeds.ply("binary_little_endian", LITTLE[:24])


def kiss(graph: str | None = None, cloud: bytes = MAP) -> dict[str, bytes]:
    good = "".join(f"VERTEX_SE3:QUAT {i} {i} 0 0 0 0 0 1\n" for i in range(3))
    return {"local_maps/local_map_graph.g2o": (good if graph is None else graph).encode(), "local_maps/plys/000000.ply": MAP,
            "local_maps/plys/000001.ply": cloud}


def kiss_cases() -> Iterator[Case]:
    vertex = "VERTEX_SE3:QUAT 0 0 0 0 0 0 0 1\n"
    for name, graph in {"empty": "", "no_vertex": "FIX 0\n", "word": vertex + "VERTEX_SE3:QUAT 1 a 0 0 0 0 0 1\n",
                        "quaternion": vertex + "VERTEX_SE3:QUAT 1 0 0 0 0 0 0 0\n", "cut": vertex + "VERTEX_SE3:QUAT 1 0 0"}.items():
        yield Case("kiss", f"graph_{name}", kiss(graph))
    for name, cloud in {"cut": MAP[:-1], "header_only": MAP[:40], "text": b"no cloud"}.items():
        yield Case("kiss", f"map_{name}", kiss(cloud=cloud))
    yield Case("kiss", "a_vertex_more", kiss(), tolerated=True)
    yield Case("kiss", "a_vertex_less", kiss(vertex), tolerated=True)  # that map is left out and counted


def lt_mapper(poses: str | None = None, cloud: bytes = CLOUD) -> dict[str, bytes]:
    good = "".join(f"1 0 0 {i} 0 1 0 0 0 0 1 0\n" for i in range(2))
    return {"optimized_poses.txt": (good if poses is None else poses).encode(), "Scans/000000.pcd": CLOUD, "Scans/000001.pcd": cloud}


def lt_mapper_cases() -> Iterator[Case]:
    row = "1 0 0 0 0 1 0 0 0 0 1 0\n"
    for name, poses in {"empty": "", "eleven": row + row[:-3] + "\n", "word": row + row.replace("1 0\n", "1 x\n"), "nan": row +
                        row.replace("1 0\n", "1 nan\n"), "mirrored": row + row.replace("1 0\n", "-1 0\n"), "zeros": row + "0 " * 12 + "\n"}.items():
        yield Case("lt_mapper", f"poses_{name}", lt_mapper(poses))
    for name, cloud in {"empty": b"", "cut": CLOUD[:-1], "text": b"no cloud\n"}.items():
        yield Case("lt_mapper", f"scan_{name}", lt_mapper(cloud=cloud))


def sequence(calib: str | None = None, poses: str | None = None, scan: bytes = SCAN) -> dict[str, bytes]:
    tr = "P0: 718 0 607 0 0 718 185 0 0 0 1 0\nTr: 0 -1 0 0.1 0 0 -1 0.2 1 0 0 0.3\n"
    rows = "".join(f"1 0 0 0 0 1 0 0 0 0 1 {i}\n" for i in range(2))
    return {"calib.txt": (tr if calib is None else calib).encode(), "poses.txt": (rows if poses is None else poses).encode(),
            "velodyne/000000.bin": SCAN, "velodyne/000001.bin": scan}


def sequence_cases() -> Iterator[Case]:
    tr = "Tr: 0 -1 0 0.1 0 0 -1 0.2 1 0 0 0.3\n"
    for name, calib in {"empty": "", "no_tr": "P0: 1 0 0 0 0 1 0 0 0 0 1 0\n", "eleven": tr[:-5] + "\n", "word": tr.replace("0.2", "up"),
                        "nan": tr.replace("0.2", "nan"), "mirrored": tr.replace("1 0 0 0.3", "-1 0 0 0.3"), "zeros": "Tr: " + "0 " * 12 + "\n"}.items():
        yield Case("sequence", f"calib_{name}", sequence(calib))
    row = "1 0 0 0 0 1 0 0 0 0 1 0\n"
    for name, poses in {"empty": "", "eleven": row + row[:-3] + "\n", "word": row + row.replace("1 0\n", "1 x\n"),
                        "scaled": row + row.replace("1 0 0 0 0", "3 0 0 0 0")}.items():
        yield Case("sequence", f"poses_{name}", sequence(poses=poses))
    for name, scan in {"empty": b"", "cut": SCAN[:-1]}.items():
        yield Case("sequence", f"scan_{name}", sequence(scan=scan))


def foreign() -> Iterator[Case]:
    """Files of programs that kilter knows of and does not read."""
    yield Case("foreign", "laz", {".laz": b"LASF" + bytes(400)})
    yield Case("foreign", "e57", {".e57": b"ASTM-E57" + bytes(400)})
    yield Case("foreign", "pbstream", {".pbstream": bytes.fromhex("7b1d1f7b5bf501db") + bytes(40)})
    yield Case("foreign", "no_format", {".xyz": b"1 2 3\n"})
    yield Case("foreign", "empty_folder", {"nothing/here.txt": b""})
    yield Case("foreign", "scans_without_poses", {"scans/000000.bin": SCAN})
    yield Case("foreign", "poses_without_scans", {"poses.tum": b"0 0 0 0 0 0 0 1\n"})
    yield Case("foreign", "cloud_of_another_name", {".ply": CLOUD})


def cases() -> Iterator[Case]:
    for family in (glim_cases, hdl_cases, kiss_cases, lt_mapper_cases, sequence_cases, foreign):
        yield from family()
