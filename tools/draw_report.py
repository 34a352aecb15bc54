#!/usr/bin/env python3
# SPDX-FileCopyrightText: The kilter authors
# SPDX-License-Identifier: BSD-3-Clause
"""Draws the README's pictures of the report from a simulated mission, docs/report*.png.

draw_report.py [--binary build/kilter]   needs node, viewer/node_modules (npm ci) and Chromium
"""

from __future__ import annotations

import argparse
import subprocess
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent


def main() -> None:
    parser = argparse.ArgumentParser(description="draws docs/report*.png from a simulated mission")
    parser.add_argument("--binary", type=Path, default=ROOT / "build/kilter")
    binary = parser.parse_args().binary
    with tempfile.TemporaryDirectory() as folder:
        mission, out = Path(folder, "office"), Path(folder, "out")
        subprocess.run([binary, "simulate", "office", "--seed", "1", "-o", mission], check=True)
        subprocess.run([binary, "check", mission / "mission", "-o", out, "--fail-on", "never", "--quiet"], check=True,
                       stdout=subprocess.DEVNULL)
        script = ROOT / "viewer/test/readme_pictures.mjs"
        subprocess.run(["node", script, out / "report.html", ROOT / "docs"], check=True)


if __name__ == "__main__":
    main()
