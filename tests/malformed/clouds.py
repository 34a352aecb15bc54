# SPDX-FileCopyrightText: The kilter authors
# SPDX-License-Identifier: BSD-3-Clause
"""Damaged .pcd, .ply, .las and .bin clouds."""

from __future__ import annotations

import struct
from collections.abc import Iterator

from .case import (COUNT_BOMBS, FAR_REALS, Case, Parts, binary_bombs, flipped, invalid, join, part_of, replaced, seeds,
                   tolerated, truncations, without)

POINTS = [(0.25 * i, 1.0, 0.5) for i in range(6)]
LITTLE = b"".join(struct.pack("<3f", *p) for p in POINTS)
TEXT = b"".join(b"%g %g %g\n" % p for p in POINTS)


def odd_points(pack: str) -> Iterator[tuple[str, bytes]]:
    """Six points, one of which no sensor has seen."""
    for bad in FAR_REALS:
        yield f"one_point_{bad}", b"".join(struct.pack(pack, *p) for p in [*POINTS[:3], (bad, 0, 0), *POINTS[4:]])


def no_points(pack: str) -> bytes:
    """Six points, none of which a sensor has seen: no cloud, unless others of the robot are better."""
    return struct.pack(pack, *3 * [FAR_REALS[0]]) * 6


# --- PCD

def pcd_parts(kind: str, body: bytes) -> Parts:
    lines = [("version", "VERSION 0.7"), ("fields", "FIELDS x y z"), ("size", "SIZE 4 4 4"), ("type", "TYPE F F F"),
             ("count", "COUNT 1 1 1"), ("width", "WIDTH 6"), ("height", "HEIGHT 1"), ("viewpoint", "VIEWPOINT 0 0 0 1 0 0 0"),
             ("points", "POINTS 6"), ("data", f"DATA {kind}")]
    return [(name, f"{line}\n".encode()) for name, line in lines] + [("body", body)]


def pcd_headers() -> Iterator[Case]:
    parts = pcd_parts("binary", LITTLE)
    for name in ("version", "count", "width", "height", "viewpoint", "points"):  # each follows from the others
        yield from tolerated("pcd", ".pcd", [(f"without_{name}", without(parts, name))])
    for name in ("fields", "size", "type", "data"):
        yield from invalid("pcd", ".pcd", [(f"without_{name}", without(parts, name))])
    for name, line in parts[:-2]:
        yield from invalid("pcd", ".pcd", [(f"twice_{name}", replaced(parts, name, line + line))])
    for key in ("width", "height", "points"):
        for bomb in COUNT_BOMBS:
            changed = replaced(parts, key, f"{key.upper()} {bomb}\n".encode())
            yield from invalid("pcd", ".pcd", [(f"{key}_{bomb or 'nothing'}", changed)])
    lines = {"size_0": "SIZE 0 4 4", "size_3": "SIZE 3 4 4", "size_16": "SIZE 16 4 4", "size_negative": "SIZE -4 4 4",
             "size_two": "SIZE 4 4", "size_four": "SIZE 4 4 4 4", "type_x": "TYPE X F F", "type_none": "TYPE",
             "type_f2": "TYPE F F F F", "count_0": "COUNT 0 1 1", "count_2": "COUNT 2 1 1", "count_negative": "COUNT -1 1 1",
             "count_bomb": "COUNT 1 1 4611686018427387904", "fields_two": "FIELDS x y", "fields_again": "FIELDS x x z",
             "fields_other": "FIELDS a b c", "version_9": "VERSION 9.9", "data_lzma": "DATA binary_lzma", "data_none": "DATA"}
    for name, line in lines.items():
        key = name.split("_")[0]
        yield from invalid("pcd", ".pcd", [(name, replaced(parts, key, f"{line}\n".encode()))])
    overflow = replaced(parts, "width", b"WIDTH 1537228672809129302\n").replace(b"POINTS 6", b"POINTS 1537228672809129302")
    area = replaced(parts, "width", b"WIDTH 4294967297\n").replace(b"HEIGHT 1", b"HEIGHT 4294967295")
    many = replaced(parts, "fields", b"FIELDS x y z" + b" _" * 100_000 + b"\n")
    yield from invalid("pcd", ".pcd", [
        ("points_times_bytes_overflow", overflow), ("width_times_height_overflow", area), ("hundred_thousand_fields", many),
        ("a_line_without_end", b"VERSION " + b"7" * 1_000_000), ("only_comments", b"# nothing\n" * 1000),
        ("zeros", bytes(4096)), ("ones", b"\xff" * 4096), ("a_ply", seeds.ply("ascii", b"1 2 3\n4 5 6\n")),
        ("control_characters", b"\x1b[2J\x07\n" * 20)])
    yield from invalid("pcd", ".pcd", truncations(parts))
    crlf = join(parts[:-1]).replace(b"\n", b"\r\n") + LITTLE
    older = join(parts).replace(b"VERSION", b"# .PCD v.5\nVERSION").replace(b"FIELDS", b"COLUMNS")
    yield from tolerated("pcd", ".pcd", [("crlf", crlf), ("byte_order_mark", b"\xef\xbb\xbf" + join(parts)),
                                         ("columns_for_fields", older), ("padded", join(parts) + bytes(1000))])


def pcd_bodies() -> Iterator[Case]:
    binary = pcd_parts("binary", LITTLE)
    for name, body in odd_points("<3f"):
        yield from tolerated("pcd", ".pcd", [(f"binary_{name}", replaced(binary, "body", body))])
    yield from invalid("pcd", ".pcd", [("binary_nothing_finite", replaced(binary, "body", no_points("<3f")))])
    for bit in range(0, 96, 7):
        yield from tolerated("pcd", ".pcd", [(f"binary_bit_{bit}", replaced(binary, "body", flipped(LITTLE, bit)))])
    yield from invalid("pcd", ".pcd", [("binary_one_point_more", replaced(binary, "body", LITTLE + LITTLE[:12]))])
    text = pcd_parts("ascii", TEXT)
    damages = {"a_word": b"0 1 2\n0 abc 2\n" + TEXT, "two_columns": TEXT.replace(b"0.25 1 0.5", b"0.25 1"),
               "four_columns": TEXT.replace(b"0.25 1 0.5", b"0.25 1 0.5 9"), "a_line_less": TEXT.split(b"\n", 1)[1],
               "a_line_more": TEXT + b"1 2 3\n", "commas": TEXT.replace(b" ", b","), "hexadecimal": TEXT.replace(b"0.25", b"0x1p1"),
               "zeros": bytes(100), "half_a_number": TEXT[:-5] + b"-\n", "one_long_line": TEXT.replace(b"\n", b" ")}
    yield from invalid("pcd", ".pcd", [(f"ascii_{name}", replaced(text, "body", body)) for name, body in damages.items()])
    yield from tolerated("pcd", ".pcd", [
        (f"ascii_{word}", replaced(text, "body", TEXT.replace(b"0.25 1 0.5", word.encode() + b" 1 0.5")))
        for word in ("nan", "-nan", "inf", "1e30", "1e400", "+0.25")])
    yield from tolerated("pcd", ".pcd", [("ascii_crlf", join(text).replace(b"\n", b"\r\n")),
                                         ("ascii_blank_lines", replaced(text, "body", TEXT.replace(b"\n", b"\n\n")))])


def pcd_compressed() -> Iterator[Case]:
    columns = struct.pack("<18f", *(p[axis] for axis in range(3) for p in POINTS))
    packed = seeds.lzf_literals(columns)

    def block(packed_bytes: int, unpacked_bytes: int, content: bytes) -> bytes:
        parts = pcd_parts("binary_compressed", struct.pack("<II", packed_bytes, unpacked_bytes) + content)
        return join(parts)

    size = len(packed)
    yield from invalid("pcd", ".pcd", [(f"compressed_{name}", content) for name, content in {
        "no_sizes": block(size, 72, packed)[:-size - 3], "no_data": block(size, 72, b""), "half": block(size, 72, packed[:40]),
        "packed_bomb": block(0xFFFFFFFF, 72, packed), "unpacked_bomb": block(size, 0xFFFFFFFF, packed),
        "unpacked_one_less": block(size, 71, packed), "unpacked_one_more": block(size, 73, packed),
        "ratio_bomb": block(2, 72, b"\x00\x00"), "reference_before_the_start": block(3, 72, b"\x20\x40\x00"),
        "reference_cut": block(5, 72, b"\x02abc\xe0"), "literals_cut": block(5, 72, b"\x1fabcd"),
        "too_little_comes_out": block(size - 33, 72, packed[:-33] if size > 66 else packed[:33]),
        "too_much_comes_out": block(size + 33, 72, packed + packed[:33]), "nothing_packed": block(0, 72, b"")}.items()])
    yield from tolerated("pcd", ".pcd", [
        ("compressed_coordinate_bit", block(size, 72, flipped(packed, 8 * 20 + 3)))])
    yield from invalid("pcd", ".pcd", [("compressed_not_finite", block(size, 72, seeds.lzf_literals(no_points("<3f"))))])


# --- PLY

def ply_parts(form: str, body: bytes) -> Parts:
    lines = [("magic", "ply"), ("format", f"format {form} 1.0"), ("vertex", "element vertex 6"), ("x", "property float x"),
             ("y", "property float y"), ("z", "property float z"), ("end", "end_header")]
    return [(name, f"{line}\n".encode()) for name, line in lines] + [("body", body)]


def ply() -> Iterator[Case]:
    parts = ply_parts("binary_little_endian", LITTLE)
    yield from invalid("ply", ".ply", [(f"without_{name}", without(parts, name)) for name, _ in parts[:-1]])
    yield from invalid("ply", ".ply", truncations(parts))
    yield from invalid("ply", ".ply", [(f"vertices_{bomb or 'nothing'}",
                                        replaced(parts, "vertex", f"element vertex {bomb}\n".encode())) for bomb in COUNT_BOMBS])
    lines = {"format_other": ("format", "format binary 1.0"), "format_2": ("format", "format ascii 2.0"),
             "format_twice": ("format", "format ascii 1.0\nformat ascii 1.0"), "type_other": ("x", "property quaternion x"),
             "type_none": ("x", "property"), "list_of_float_length": ("x", "property list float int n\nproperty float x"),
             "x_twice": ("y", "property float x"), "x_a_list": ("x", "property list uchar float x"),
             "vertex_twice": ("end", "element vertex 6\nend_header"), "property_first": ("format", "format ascii 1.0\nproperty int n"),
             "a_word": ("end", "nonsense\nend_header"), "vertices_overflow": ("vertex", "element vertex 1537228672809129302")}
    yield from invalid("ply", ".ply", [(name, replaced(parts, key, f"{line}\n".encode())) for name, (key, line) in lines.items()])
    yield from invalid("ply", ".ply", [("one_vertex_more", join(parts) + LITTLE[:12]), ("zeros", bytes(4096)),
                                       ("ones", b"\xff" * 4096), ("a_line_without_end", b"ply\ncomment " + b"c" * 1_000_000)])
    for kind, pack in (("binary_little_endian", "<3f"), ("binary_big_endian", ">3f")):
        for name, body in odd_points(pack):
            yield from tolerated("ply", ".ply", [(f"{kind}_{name}", join(ply_parts(kind, body)))])
        yield from invalid("ply", ".ply", [(f"{kind}_nothing_finite", join(ply_parts(kind, no_points(pack))))])
    yield from tolerated("ply", ".ply", [
        ("big_endian_bit", join(ply_parts("binary_big_endian", flipped(LITTLE, 77)))), ("byte_order_mark", b"\xef\xbb\xbf" + join(parts)),
        ("crlf", join(parts[:-1]).replace(b"\n", b"\r\n") + LITTLE),
        ("comments", replaced(parts, "format", part_of(parts, "format") + b"comment \xff\xfe\x1b[2J\nobj_info none\n")),
        ("rows_of_nothing", replaced(parts, "vertex", b"element nothing 4000000000\nelement vertex 6\n"))])
    text = ply_parts("ascii", TEXT)
    yield from invalid("ply", ".ply", [(f"ascii_{name}", replaced(text, "body", body)) for name, body in {
        "a_word": TEXT.replace(b"0.25", b"x"), "two_columns": TEXT.replace(b"0.25 1 0.5", b"0.25 1"),
        "a_line_less": TEXT.split(b"\n", 1)[1], "a_line_more": TEXT + b"1 2 3\n", "zeros": bytes(60)}.items()])
    yield from tolerated("ply", ".ply", [("ascii_nan", join(text).replace(b"0.25 1", b"nan 1")),
                                         ("ascii_inf", join(text).replace(b"0.25 1", b"-inf 1"))])


def ply_lists() -> Iterator[Case]:
    def faces(length: str, rows: int, content: bytes) -> bytes:
        line = f"element face {rows}\nproperty list {length} int vertex_indices\nelement vertex 6\n"
        return replaced(ply_parts("binary_little_endian", content + LITTLE), "vertex", line.encode())

    yield from invalid("ply", ".ply", [
        ("list_negative", faces("char", 1, b"\xff")), ("list_longer_than_the_file", faces("uint", 1, struct.pack("<I", 0xFFFFFFFF))),
        ("list_overflow", faces("uint", 1, struct.pack("<I", 0x40000000))), ("lists_four_billion", faces("uchar", 4_000_000_000, b"\0")),
        ("list_takes_the_vertices", faces("uchar", 1, b"\x12" + bytes(4))), ("list_length_int64", faces("int64", 1, b"\xff" * 8))])
    yield from tolerated("ply", ".ply", [("list_empty", faces("uchar", 1, b"\0")), ("list_of_two", faces("uchar", 1, b"\2" + bytes(8)))])


# --- LAS

def las_parts() -> Parts:
    """Version 1.2, point format 1, six points; the fields that say what is there are parts of their own."""
    whole = seeds.las(2, 1, 28, 6)
    cuts = [("magic", 4), ("source", 24), ("version", 26), ("texts", 94), ("header_bytes", 96), ("points_at", 100), ("records", 104),
            ("kind", 105), ("point_bytes", 107), ("points", 111), ("returns", 131), ("scale", 155), ("offset", 179), ("extent", 227),
            ("body", len(whole))]
    starts = [0, *(end for _, end in cuts[:-1])]
    return [(name, whole[start:end]) for (name, end), start in zip(cuts, starts, strict=True)]


def las() -> Iterator[Case]:
    parts = las_parts()
    yield from invalid("las", ".las", truncations(parts))
    changes: dict[str, tuple[str, bytes]] = {
        "magic_other": ("magic", b"LASX"), "version_2_0": ("version", b"\2\0"), "version_1_9": ("version", b"\1\x09"),
        "header_0": ("header_bytes", bytes(2)), "header_1": ("header_bytes", b"\1\0"), "header_65535": ("header_bytes", b"\xff\xff"),
        "points_in_the_header": ("points_at", struct.pack("<I", 100)), "compressed": ("kind", b"\x81"), "kind_11": ("kind", b"\x0b"),
        "kind_63": ("kind", b"\x3f"), "point_bytes_0": ("point_bytes", bytes(2)), "point_bytes_27": ("point_bytes", b"\x1b\0"),
        "point_bytes_65535": ("point_bytes", b"\xff\xff"), "one_point_more": ("points", struct.pack("<I", 7)),
        "scale_0": ("scale", struct.pack("<3d", 0, 0.01, 0.01)), "scale_nan": ("scale", struct.pack("<3d", 0.01, FAR_REALS[0], 0.01)),
        "offset_inf": ("offset", struct.pack("<3d", 0, 0, FAR_REALS[1])), "all_far_away": ("offset", struct.pack("<3d", 5e5, 5e6, 0)),
        "records_of_nothing": ("records", struct.pack("<I", 3))}
    for key, size in (("points", 4), ("points_at", 4), ("records", 4)):
        changes |= {f"{key}_{name}": (key, content) for name, content in binary_bombs(size)}
    yield from invalid("las", ".las", [(name, replaced(parts, key, content)) for name, (key, content) in changes.items()])
    four = seeds.las(4, 6, 30, 6)
    yield from invalid("las", ".las", [(f"count64_{name}", four[:247] + content + four[255:]) for name, content in binary_bombs(8)])
    yield from invalid("las", ".las", [("zeros", bytes(4096)), ("ones", b"LASF" + b"\xff" * 4096)])
    body = part_of(parts, "body")
    yield from tolerated("las", ".las", [(f"bit_{bit}", replaced(parts, "body", flipped(body, bit))) for bit in (3, 40, 75, 130)])
    yield from tolerated("las", ".las", [("a_point_less", replaced(parts, "points", struct.pack("<I", 5))),
                                         ("extent_wrong", replaced(parts, "extent", b"\xff" * 48)),
                                         ("returns_wrong", replaced(parts, "returns", b"\xff" * 20))])


# --- KITTI .bin, which are scans of a robot

def robot(scans: list[bytes], poses: bytes | None = None, suffix: str = "bin") -> dict[str, bytes]:
    text = b"".join(b"%d %d 0 0 0 0 0 1\n" % (i, i) for i in range(len(scans))) if poses is None else poses
    return {"poses.tum": text} | {f"scans/{i:06}.{suffix}": scan for i, scan in enumerate(scans)}


def bins() -> Iterator[Case]:
    good = b"".join(struct.pack("<4f", *p, 0.5) for p in POINTS)
    for name, scan in {"empty": b"", "one_byte": b"\0", "one_byte_less": good[:-1], "one_byte_more": good + b"\0",
                       "three_floats": good[:-4], "text": b"0 1 2 3\n" * 3}.items():
        yield Case("bin", name, robot([good, scan]))
    for name, scan in odd_points("<3f4x"):
        yield Case("bin", name, robot([good, scan]), tolerated=True)
    yield Case("bin", "nothing_finite", robot([good, no_points("<3f4x")]), tolerated=True)
    for bit in (0, 31, 62, 95, 120):
        yield Case("bin", f"bit_{bit}", robot([good, flipped(good, bit)]), tolerated=True)


def cases() -> Iterator[Case]:
    for family in (pcd_headers, pcd_bodies, pcd_compressed, ply, ply_lists, las, bins):
        yield from family()
