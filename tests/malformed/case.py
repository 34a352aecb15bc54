# SPDX-FileCopyrightText: The kilter authors
# SPDX-License-Identifier: BSD-3-Clause
"""One damaged input, and the ways in which a file made of named parts is damaged.

A part is a field of the format: its name, its bytes. Damages say by themselves whether the file is still one of its
format (`tolerated`: other values, nothing lost) or none any more (`invalid`: something that must be there is not, or two
statements contradict each other). No reader is asked.
"""

from __future__ import annotations

import struct
import sys
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent.parent.parent / "fuzz"))
import make_corpus as seeds  # noqa: E402, F401  (small valid files of every variant; used by the modules beside this one)

NAN, INF = float("nan"), float("inf")

# Texts in the place of a count: none of them is one that the bytes behind it justify.
COUNT_BOMBS = ("-1", "4294967295", "9223372036854775807", "18446744073709551615", "18446744073709551616", "1e9", "nan",
               "0x10", "two", "2.5", "")
# The same for binary counts, as bits.
BINARY_BOMBS = (0xFFFF_FFFF_FFFF_FFFF, 0x8000_0000_8000_0000, 0x7FFF_FFFF_7FFF_FFFF)
# Texts in the place of a number of a pose.
NO_REALS = ("word", "nan", "inf", "-inf", "1e400", "0x1p3", "1,5", "--1", "1e")
# Coordinates of a point that no sensor has seen: such points are dropped and counted.
FAR_REALS = (NAN, INF, -INF, 1e30, -3e38)


@dataclass(frozen=True)
class Case:
    """`files` by path in the case's folder; a single one without a folder has the path of just a suffix, ".pcd"."""

    format: str
    name: str
    files: dict[str, bytes]
    tolerated: bool = False

    def write(self, root: Path) -> Path:
        """Writes it to root/invalid or root/tolerated. Returns what a user would name as the source."""
        base = root / ("tolerated" if self.tolerated else "invalid") / self.format / self.name
        for path, content in self.files.items():
            file = Path(f"{base}{path}") if path.startswith(".") else base / path
            file.parent.mkdir(parents=True, exist_ok=True)
            file.write_bytes(content)
        only = next(iter(self.files))
        return Path(f"{base}{only}") if only.startswith(".") else base


Parts = list[tuple[str, bytes]]


def join(parts: Parts) -> bytes:
    return b"".join(content for _, content in parts)


def replaced(parts: Parts, name: str, content: bytes) -> bytes:
    """The file with one part changed; it must exist."""
    assert any(part == name for part, _ in parts), name
    return b"".join(content if part == name else old for part, old in parts)


def without(parts: Parts, name: str) -> bytes:
    return replaced(parts, name, b"")


def flipped(content: bytes, bit: int) -> bytes:
    changed = bytearray(content)
    changed[bit // 8] ^= 1 << bit % 8
    return bytes(changed)


def part_of(parts: Parts, name: str) -> bytes:
    return next(content for part, content in parts if part == name)


def truncations(parts: Parts) -> Iterator[tuple[str, bytes]]:
    """Cut before every part and in the middle of every part; never the whole file, and the empty one once."""
    whole = join(parts)
    start = 0
    for name, content in parts:
        if content:
            yield f"cut_before_{name}", whole[:start]
        if len(content) > 1:
            yield f"cut_inside_{name}", whole[:start + len(content) // 2]
        start += len(content)


def binary_bombs(size: int) -> Iterable[tuple[str, bytes]]:
    """Little-endian numbers of `size` bytes that count more than there is."""
    for bomb in BINARY_BOMBS:
        content = struct.pack("<Q", bomb)[:size]
        yield f"bomb_{content[::-1].hex()}", content


def invalid(format_: str, suffix: str, damages: Iterable[tuple[str, bytes]]) -> Iterator[Case]:
    return (Case(format_, name, {suffix: content}) for name, content in damages)


def tolerated(format_: str, suffix: str, damages: Iterable[tuple[str, bytes]]) -> Iterator[Case]:
    return (Case(format_, name, {suffix: content}, tolerated=True) for name, content in damages)
