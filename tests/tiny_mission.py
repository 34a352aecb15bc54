# SPDX-FileCopyrightText: The kilter authors
# SPDX-License-Identifier: BSD-3-Clause
"""Missions small enough to be checked in about a second, for tests that drive the program.

    with TinyMission() as tiny:
        run_kilter("check", tiny.mission, "-o", tiny.folder / "out")

`mission` has robots a and b with one planted fault (scripts/make_tiny_mission.py); `truth` the right poses for it, to be
given as --poses; `apart` right poses too, but b's a kilometre off, so that the robots never meet.
"""

from __future__ import annotations

import json
import shutil
import sys
import tempfile
from pathlib import Path

from kilter_runner import SOURCE_DIR

sys.path.insert(0, str(SOURCE_DIR / "scripts"))
import make_tiny_mission  # noqa: E402


class TinyMission:
    """A folder of its own, removed at the end."""

    def __enter__(self) -> TinyMission:
        self.folder = Path(tempfile.mkdtemp(prefix="kilter_tiny_"))
        make_tiny_mission.write(self.folder)
        self.mission = self.folder / "mission"
        self.truth = self.folder / "truth"
        self.apart = self.folder / "apart"
        for robot, shift_m in (("a", 0.0), ("b", 1000.0)):
            (self.apart / robot).mkdir(parents=True)
            rows = (line.split() for line in (self.truth / robot / "poses.tum").read_text().splitlines())
            moved = (" ".join([t, str(float(x) + shift_m), *rest]) for t, x, *rest in rows)
            (self.apart / robot / "poses.tum").write_text("\n".join(moved) + "\n")
        return self

    def __exit__(self, *_: object) -> None:
        shutil.rmtree(self.folder)

    def copy(self, name: str, robots: str = "a", scans: int = 3) -> Path:
        """A fresh mission of the first scans of some robots, to be damaged; replaces one of the same name."""
        target = self.folder / name
        shutil.rmtree(target, ignore_errors=True)
        for robot in robots:
            (target / robot / "scans").mkdir(parents=True)
            poses = (self.truth / robot / "poses.tum").read_text().splitlines()[:scans]
            (target / robot / "poses.tum").write_text("\n".join(poses) + "\n")
            for scan in sorted((self.mission / robot / "scans").iterdir())[:scans]:
                shutil.copy(scan, target / robot / "scans")
        return target


def read_result(folder: Path) -> dict:
    """An output folder's result.json."""
    return json.loads((folder / "result.json").read_text(encoding="utf-8"))


def bytes_below(folder: Path) -> dict[str, bytes]:
    """All files of a folder and the folders in it."""
    return {str(file.relative_to(folder)): file.read_bytes() for file in sorted(folder.rglob("*")) if file.is_file()}
