#!/usr/bin/env python3
# SPDX-FileCopyrightText: The kilter authors
# SPDX-License-Identifier: BSD-3-Clause
"""Writes the corpus: `python3 -m malformed.write FOLDER` from tests/, FOLDER/invalid and FOLDER/tolerated come out."""

from __future__ import annotations

import sys
from collections import Counter
from collections.abc import Iterator
from pathlib import Path

from . import bags, clouds, documents, layouts, poses, trees
from .case import Case


def all_cases() -> Iterator[Case]:
    for module in (clouds, trees, poses, layouts, bags, documents):
        yield from module.cases()


def main() -> None:
    folder = Path(sys.argv[1])
    counts: Counter[tuple[str, bool]] = Counter()
    for case in all_cases():
        case.write(folder)
        counts[case.format, case.tolerated] += 1
    for name in dict.fromkeys(format_ for format_, _ in counts):
        print(f"{name:<10} {counts[name, False]:>4} invalid {counts[name, True]:>4} tolerated")
    print(f"{'all':<10} {sum(n for (_, t), n in counts.items() if not t):>4} invalid "
          f"{sum(n for (_, t), n in counts.items() if t):>4} tolerated")


if __name__ == "__main__":
    main()
