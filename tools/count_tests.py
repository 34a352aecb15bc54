#!/usr/bin/env python3
# SPDX-FileCopyrightText: The kilter authors
# SPDX-License-Identifier: BSD-3-Clause
"""Prints "PASSED FAILED SKIPPED" of a report of `ctest --output-junit`.

A test that asked to be skipped is skipped; one that could not be started (its program is missing) has failed, though
ctest's own summary of the report counts both as skipped.
"""

from __future__ import annotations

import sys
import xml.etree.ElementTree as ElementTree
from pathlib import Path

ASKED_TO_BE_SKIPPED = ("SKIP_RETURN_CODE", "SKIP_REGULAR_EXPRESSION_MATCHED", "Disabled")


def outcome(test: ElementTree.Element) -> str:
    """"passed", "failed" or "skipped" of one <testcase>."""
    skip = test.find("skipped")
    if test.get("status") == "run" and test.find("failure") is None and skip is None:
        return "passed"
    if skip is not None and skip.get("message", "").startswith(ASKED_TO_BE_SKIPPED):
        return "skipped"
    return "skipped" if test.get("status") == "disabled" else "failed"


def count(report: Path) -> dict[str, int]:
    """How many tests of the report had each outcome; an empty or missing report counts none."""
    counts = {"passed": 0, "failed": 0, "skipped": 0}
    if report.is_file() and report.stat().st_size > 0:
        for test in ElementTree.parse(report).getroot().iter("testcase"):
            counts[outcome(test)] += 1
    return counts


if __name__ == "__main__":
    counted = count(Path(sys.argv[1]))
    print(counted["passed"], counted["failed"], counted["skipped"])
