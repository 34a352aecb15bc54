# SPDX-FileCopyrightText: The kilter authors
# SPDX-License-Identifier: BSD-3-Clause
"""Damaged OctoMap trees, .ot and .bt."""

from __future__ import annotations

from collections.abc import Iterator

from .case import COUNT_BOMBS, INF, NAN, Case, Parts, invalid, join, part_of, replaced, seeds, tolerated, truncations, without

LEVELS = 16


def tree_parts(first: str, size: int, body: list[tuple[str, bytes]]) -> Parts:
    lines = [("first", first), ("comment", "# made by hand"), ("id", "id OcTree"), ("size", f"size {size}"), ("res", "res 0.1"),
             ("data", "data")]
    return [(name, f"{line}\n".encode()) for name, line in lines] + body


def headers(format_: str, parts: Parts) -> Iterator[Case]:
    suffix = f".{format_}"
    yield from invalid(format_, suffix, truncations(parts))
    for name in ("first", "id", "size", "res", "data"):
        yield from invalid(format_, suffix, [(f"without_{name}", without(parts, name))])
    yield from tolerated(format_, suffix, [("without_comment", without(parts, "comment")),
                                           ("crlf", join(parts[:6]).replace(b"\n", b"\r\n") + join(parts[6:])),
                                           ("padded", join(parts) + bytes(64))])
    for bomb in COUNT_BOMBS:
        yield from invalid(format_, suffix, [(f"size_{bomb or 'nothing'}", replaced(parts, "size", f"size {bomb}\n".encode()))])
    for word in ("0", "-0.1", "nan", "inf", "1e-300", "1e30", "word", ""):
        yield from invalid(format_, suffix, [(f"res_{word or 'nothing'}", replaced(parts, "res", f"res {word}\n".encode()))])
    count = int(part_of(parts, "size").split()[1])
    yield from invalid(format_, suffix, [
        ("id_other", replaced(parts, "id", b"id CountingOcTree\n")), ("one_node_more", replaced(parts, "size", b"size %d\n" % (count + 1))),
        ("one_node_less", replaced(parts, "size", b"size %d\n" % (count - 1))), ("no_nodes", replaced(parts, "size", b"size 0\n")),
        ("bytes_behind", join(parts) + b"more"), ("zeros", bytes(4096)), ("ones", b"\xff" * 4096),
        ("comments_without_end", part_of(parts, "first") + b"# again and again\n" * 10_000)])


def full() -> Iterator[Case]:
    first = "# Octomap OcTree file"
    nodes = [("chain", seeds.node(0.85, 128) + (LEVELS - 2) * seeds.node(0.85, 1)), ("parent", seeds.node(0.85, 33)),
             ("occupied", seeds.node(0.85, 0)), ("free", seeds.node(-0.4, 0))]
    parts = tree_parts(first, LEVELS + 2, nodes)
    yield from headers("ot", parts)
    for name, value in (("nan", NAN), ("inf", INF), ("minus_inf", -INF)):
        yield from invalid("ot", ".ot", [(f"leaf_{name}", replaced(parts, "occupied", seeds.node(value, 0)))])
    chain = tree_parts(first, 4000, [("chain", seeds.node(1.0, 1) * 4000)])
    wide = tree_parts(first, 4000, [("wide", seeds.node(1.0, 255) * 4000)])
    level = tree_parts(first, LEVELS + 2, [("chain", seeds.node(1.0, 1) * (LEVELS + 1) + seeds.node(1.0, 0))])
    yield from invalid("ot", ".ot", [("deeper_than_the_levels", join(chain)), ("one_level_too_deep", join(level)),
                                     ("children_that_never_come", join(wide)),
                                     ("a_cell_of_kilometres", join(tree_parts(first, 2, [("root", seeds.node(1, 1) + seeds.node(1, 0))]))),
                                     ("says_it_is_binary", replaced(parts, "first", b"# Octomap OcTree binary file\n"))])
    yield from tolerated("ot", ".ot", [
        ("inner_nan", replaced(parts, "parent", seeds.node(NAN, 33))), ("huge_log_odds", replaced(parts, "occupied", seeds.node(3e38, 0))),
        ("stamped", replaced(parts, "id", b"id OcTreeStamped\n")), ("only_free", replaced(parts, "occupied", seeds.node(-0.4, 0)))])


def binary() -> Iterator[Case]:
    first = "# Octomap OcTree binary file"
    # Bits 11 of a child: an inner node; 10: occupied; 01: free.
    parts = tree_parts(first, LEVELS + 1, [("root", b"\x00\xc0"), ("inner", (LEVELS - 2) * b"\x03\x00"), ("parent", b"\x02\x00")])
    yield from headers("bt", parts)
    chain = tree_parts(first, 4001, [("chain", b"\x03\x00" * 4000)])
    level = tree_parts(first, LEVELS + 2, [("chain", b"\x03\x00" * LEVELS + b"\x02\x00")])
    wide = tree_parts(first, 32001, [("wide", b"\xff\xff" * 4000)])
    yield from invalid("bt", ".bt", [
        ("deeper_than_the_levels", join(chain)), ("one_level_too_deep", join(level)), ("children_that_never_come", join(wide)),
        ("a_node_without_children", replaced(parts, "parent", bytes(2))), ("a_cell_of_kilometres", join(tree_parts(first, 2, [("root", b"\2\0")]))),
        ("says_it_is_full", replaced(parts, "first", b"# Octomap OcTree file\n")),
        ("before_version_1", (seeds.CORPUS / "bt" / "old").read_bytes())])
    yield from tolerated("bt", ".bt", [("free_for_occupied", replaced(parts, "parent", b"\x01\x00"))])


def cases() -> Iterator[Case]:
    yield from full()
    yield from binary()
