# SPDX-FileCopyrightText: The kilter authors
# SPDX-License-Identifier: BSD-3-Clause
"""The closing line of scripts/test tells what ctest really saw."""

import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
sys.path.insert(0, str(ROOT / "tools"))
import count_tests  # noqa: E402  (found only after the line above)

FOUR_FATES = """
add_test(passes "/bin/sh" "-c" "exit 0")
add_test(fails "/bin/sh" "-c" "exit 1")
add_test(skips "/bin/sh" "-c" "exit 77")
set_tests_properties(skips PROPERTIES SKIP_RETURN_CODE 77)
add_test(was_never_built "no-such-program")
add_test(is_switched_off "/bin/sh" "-c" "exit 0")
set_tests_properties(is_switched_off PROPERTIES DISABLED TRUE)
"""


class CountTests(unittest.TestCase):
    def test_a_test_that_could_not_start_has_failed_and_only_those_that_asked_are_skipped(self):
        with tempfile.TemporaryDirectory() as folder:
            Path(folder, "CTestTestfile.cmake").write_text(FOUR_FATES, encoding="utf-8")
            report = Path(folder, "report.xml")
            subprocess.run(["ctest", "--output-junit", str(report)], cwd=folder, capture_output=True, check=False)
            self.assertEqual(count_tests.count(report), {"passed": 1, "failed": 2, "skipped": 2})

    def test_no_report_counts_nothing(self):
        self.assertEqual(count_tests.count(Path("/no/such/report")), {"passed": 0, "failed": 0, "skipped": 0})


if __name__ == "__main__":
    unittest.main()
