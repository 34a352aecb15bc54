# SPDX-FileCopyrightText: The kilter authors
# SPDX-License-Identifier: BSD-3-Clause
"""The tree is tidy, and the checker would notice if it were not."""

import sys
import tempfile
import unittest
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
sys.path.insert(0, str(ROOT / "tools"))
import check_tree  # noqa: E402  (found only after the line above)

HEAD = "// SPDX-FileCopyrightText: The kilter authors\n// SPDX-License-Identifier: BSD-3-Clause\n"


class CheckTree(unittest.TestCase):
    def test_the_project_is_tidy(self):
        self.assertEqual(check_tree.check(ROOT), [])

    def test_a_file_without_licence_lines_is_named(self):
        self.assertEqual(len(check_tree.objections("int x;\n")), 2)
        self.assertEqual(check_tree.objections(HEAD + "int x;\n"), [])

    def test_a_file_that_grew_too_long_is_named(self):
        self.assertEqual(len(check_tree.objections(HEAD + "\n" * (check_tree.LONGEST - 1))), 1)

    def test_unfinished_work_is_named_with_its_line(self):
        self.assertEqual(check_tree.objections(HEAD + "int x;  // TO" + "DO\n"), ["line 3: unfinished"])

    def test_a_source_that_nobody_builds_is_named(self):
        with tempfile.TemporaryDirectory() as folder:
            module = Path(folder, "src/kilter/io")
            module.mkdir(parents=True)
            (module / "CMakeLists.txt").write_text("kilter_module(io\n  SOURCES a.cc detail/b.cc)\n", encoding="utf-8")
            (module / "detail").mkdir()
            for name in ("a.cc", "detail/b.cc", "forgotten.cc"):
                (module / name).write_text(HEAD, encoding="utf-8")
            self.assertEqual(check_tree.check(Path(folder)), ["src/kilter/io/forgotten.cc: no CMakeLists.txt names it"])

    def test_a_source_that_hides_what_its_header_lacks_is_named(self):
        with tempfile.TemporaryDirectory() as folder:
            source = Path(folder, "src/kilter/io/a.cc")
            source.parent.mkdir(parents=True)
            source.write_text('#include <vector>\n#include "kilter/io/a.h"\n', encoding="utf-8")
            self.assertFalse(check_tree.hides_its_header(source))
            source.with_suffix(".h").touch()
            self.assertTrue(check_tree.hides_its_header(source))
            source.write_text('#include "kilter/io/a.h"\n\n#include <vector>\n', encoding="utf-8")
            self.assertFalse(check_tree.hides_its_header(source))

    def test_a_test_that_nobody_runs_is_named(self):
        with tempfile.TemporaryDirectory() as folder:
            tests = Path(folder, "tests")
            tests.mkdir()
            (tests / "CMakeLists.txt").write_text("kilter_python_test(run_test.py)\n", encoding="utf-8")
            for name in ("run_test.py", "forgotten_test.py", "kilter_runner.py"):
                (tests / name).touch()
            self.assertEqual(check_tree.unregistered(Path(folder)), [tests / "forgotten_test.py"])


if __name__ == "__main__":
    unittest.main()
