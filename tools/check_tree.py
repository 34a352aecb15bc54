#!/usr/bin/env python3
# SPDX-FileCopyrightText: The kilter authors
# SPDX-License-Identifier: BSD-3-Clause
"""Checks what no compiler does: licence lines, length of files, own headers first, forgotten files, unfinished work.

check_tree.py [--root DIR]   prints each violation as file: reason; exit status 1 if there is one
"""

from __future__ import annotations

import argparse
import re
import sys
from pathlib import Path

FOLDERS = ("src", "apps", "testing", "tests", "fuzz", "tools", "scripts", "benchmarks")
LICENCE = ("SPDX-FileCopyrightText: The kilter authors", "SPDX-License-Identifier: BSD-3-Clause")
LONGEST = 400  # lines that fit a reader's head
UNFINISHED = re.compile(r"\b(TO" r"DO|FIX" r"ME|XX" r"X)\b")  # split, or this line would find itself


def sources(root: Path) -> list[Path]:
    """C++ and Python files of ours, sorted."""
    found = (path for folder in FOLDERS for path in (root / folder).rglob("*"))
    return sorted(path for path in found if path.suffix in {".h", ".cc", ".py"} and path.is_file())


def objections(text: str) -> list[str]:
    """What is wrong with one file's text."""
    lines = text.splitlines()
    head = "\n".join(lines[:3])
    found = [f"lacks '{line}' at its top" for line in LICENCE if line not in head]
    if len(lines) > LONGEST:
        found.append(f"has {len(lines)} lines; split it before it passes {LONGEST}")
    found += [f"line {n}: unfinished" for n, line in enumerate(lines, start=1) if UNFINISHED.search(line)]
    return found


def hides_its_header(path: Path) -> bool:
    """Whether a source includes something before the header of its name, which then need not compile alone."""
    if path.suffix != ".cc" or not path.with_suffix(".h").is_file():
        return False
    first = re.search(r'^\s*#\s*include\s+(\S+)', path.read_text(encoding="utf-8"), re.MULTILINE)
    return not first or not path.with_suffix(".h").as_posix().endswith("/" + first.group(1).strip('"<>'))


def unbuilt(root: Path) -> list[Path]:
    """Files below a CMakeLists.txt of a module or program that it does not name: nobody builds or installs them."""
    found = []
    for folder in (root / "src/kilter", root / "apps"):
        for cmake_file in sorted(folder.glob("*/CMakeLists.txt")):
            owner = cmake_file.parent
            words = {word.strip('()"') for word in cmake_file.read_text(encoding="utf-8").split()}
            files = (path for path in sorted(owner.rglob("*")) if path.suffix in {".h", ".cc"})
            found += [path for path in files if path.relative_to(owner).as_posix() not in words]
    return found


def unregistered(root: Path) -> list[Path]:
    """Test files of tests/ that its CMakeLists.txt does not name: nobody runs them."""
    cmake_file = root / "tests/CMakeLists.txt"
    text = cmake_file.read_text(encoding="utf-8") if cmake_file.is_file() else ""
    return [path for path in sorted((root / "tests").glob("*_test.py")) if f"({path.name}" not in text]


def check(root: Path) -> list[str]:
    """All violations of the tree at `root`."""
    found = [f"{path.relative_to(root)}: {reason}" for path in sources(root)
             for reason in objections(path.read_text(encoding="utf-8"))]
    found += [f"{path.relative_to(root)}: includes something before the header of its name" for path in sources(root)
              if hides_its_header(path)]
    forgotten = unbuilt(root) + unregistered(root)
    return found + [f"{path.relative_to(root)}: no CMakeLists.txt names it" for path in forgotten]


def main() -> int:
    parser = argparse.ArgumentParser(description="checks licence lines, length of files and forgotten files")
    parser.add_argument("--root", type=Path, default=Path(__file__).resolve().parent.parent)
    violations = check(parser.parse_args().root)
    for violation in violations:
        print(violation, file=sys.stderr)
    return 1 if violations else 0


if __name__ == "__main__":
    sys.exit(main())
