#!/usr/bin/env python3
# SPDX-FileCopyrightText: The kilter authors
# SPDX-License-Identifier: BSD-3-Clause
"""Checks that every #include and every USES goes down the floors of layers.toml.

check_layers.py [--root DIR]          prints each violation as file:line: reason; exit status 1 if there is one
check_layers.py [--root DIR] --draw   prints the floors
"""

from __future__ import annotations

import argparse
import re
import sys
import tomllib
from dataclasses import dataclass
from pathlib import Path

INCLUDE = re.compile(r'^\s*#\s*include\s*[<"](?P<path>[^>"]+)[>"]')
MODULE_CALL = re.compile(r"kilter_module\(\s*(?P<name>\w+)(?P<body>[^)]*)\)")
KEYWORDS = {"HEADERS", "SOURCES", "TESTS", "USES", "LINKS", "PRIVATE_LINKS"}
SUFFIXES = {".h", ".cc", ".cpp", ".inc"}


@dataclass(frozen=True)
class Floor:
    level: int
    name: str
    modules: dict[str, str]  # module -> what it holds


def read_floors(root: Path) -> list[Floor]:
    """The floors from the roof down, as layers.toml lists them."""
    with open(root / "layers.toml", "rb") as file:
        return [Floor(**row) for row in tomllib.load(file)["floor"]]


def heights(floors: list[Floor]) -> dict[str, int]:
    """Module -> height; only a strictly lower module may be included."""
    return {module: len(floors) - row for row, floor in enumerate(floors) for module in floor.modules}


def objection(user: str, used: str, height: dict[str, int]) -> str | None:
    """Why `user` must not include `used`; None if it may."""
    if user == used:
        return None
    if used not in height:
        return f"module '{used}' is not in layers.toml"
    if height[used] > height[user]:
        return f"{user} must not look up to {used}"
    if height[used] == height[user]:
        return f"{user} must not look sideways to {used}"
    return None


def check_file(file: Path, module: str, root: Path, height: dict[str, int]) -> list[str]:
    """Violations of one source file that belongs to `module`."""
    found = []
    is_test = file.stem.endswith("_test")
    for number, line in enumerate(file.read_text(encoding="utf-8").splitlines(), start=1):
        match = INCLUDE.match(line)
        if not match:
            continue
        parts = match["path"].split("/")
        reason = None
        if parts[0] == "kilter" and len(parts) > 2:
            reason = objection(module, parts[1], height)
        elif parts[0] == "testing" and not is_test:
            reason = "only tests include testing/"
        elif parts[0] == "apps" and module != "apps":
            reason = f"{module} must not look up to apps"
        if reason:
            found.append(f"{file.relative_to(root)}:{number}: {reason} ({match['path']})")
    return found


def check_uses(cmake_file: Path, root: Path, height: dict[str, int]) -> list[str]:
    """Violations among the USES of the kilter_module() calls of one CMakeLists.txt."""
    found = []
    for call in MODULE_CALL.finditer(cmake_file.read_text(encoding="utf-8")):
        section = None
        for word in call["body"].split():
            section = word if word in KEYWORDS else section
            reason = objection(call["name"], word, height) if section == "USES" and word != section else None
            if reason:
                found.append(f"{cmake_file.relative_to(root)}: {reason} (USES)")
    return found


def check(root: Path) -> list[str]:
    """All violations of the tree at `root`, sorted by file."""
    height = heights(read_floors(root))
    found = []
    folders = [(folder, folder.name) for folder in sorted((root / "src/kilter").iterdir()) if folder.is_dir()]
    folders += [(root / "apps", "apps")] if (root / "apps").is_dir() else []
    for folder, module in folders:
        if module not in height:
            found.append(f"{folder.relative_to(root)}: module '{module}' is not in layers.toml")
            continue
        for file in sorted(path for path in folder.rglob("*") if path.suffix in SUFFIXES):
            found += check_file(file, module, root, height)
        for cmake_file in sorted(folder.rglob("CMakeLists.txt")):
            found += check_uses(cmake_file, root, height)
    return found


def draw(floors: list[Floor]) -> str:
    """The floors as text, the roof first; neighbours, who must not know each other, share a number."""
    rows = []
    name_width = max(len(floor.name) for floor in floors)
    module_width = max(len(module) for floor in floors for module in floor.modules)
    for floor in floors:
        head = f"{floor.level}  {floor.name:<{name_width}}"
        for module, holds in floor.modules.items():
            rows.append(f"{head}  {module:<{module_width}}  {holds}")
            head = " " * len(head)
    return "\n".join(rows)


def main() -> int:
    parser = argparse.ArgumentParser(description="checks #include and USES against layers.toml")
    parser.add_argument("--root", type=Path, default=Path(__file__).resolve().parent.parent)
    parser.add_argument("--draw", action="store_true", help="print the floors instead")
    arguments = parser.parse_args()
    if arguments.draw:
        print(draw(read_floors(arguments.root)))
        return 0
    violations = check(arguments.root)
    for violation in violations:
        print(violation, file=sys.stderr)
    if not violations:
        print("every include goes down")
    return 1 if violations else 0


if __name__ == "__main__":
    sys.exit(main())
