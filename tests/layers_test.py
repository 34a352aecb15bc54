# SPDX-FileCopyrightText: The kilter authors
# SPDX-License-Identifier: BSD-3-Clause
"""The floors hold, and the checker would notice if they did not."""

import os
import sys
import tempfile
import unittest
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
sys.path.insert(0, str(ROOT / "tools"))
import check_layers  # noqa: E402  (found only after the line above)


class Tree:
    """A throw-away source tree under the project's own layers.toml."""

    def __init__(self, folder: str):
        self.root = Path(folder)
        (self.root / "layers.toml").write_bytes((ROOT / "layers.toml").read_bytes())
        (self.root / "src/kilter").mkdir(parents=True)

    def add(self, name: str, text: str) -> None:
        path = self.root / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, encoding="utf-8")


class Layers(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.tree = Tree(folder.name)

    def test_the_project_goes_down_only(self):
        self.assertEqual(check_layers.check(ROOT), [])

    def test_a_lower_floor_and_the_own_module_are_allowed(self):
        self.tree.add("src/kilter/submap/a.cc", '#include "kilter/submap/a.h"\n#include "kilter/base/expected.h"\n')
        self.tree.add("apps/kilter/main.cc", '#include "kilter/io/poses.h"\n')
        self.assertEqual(check_layers.check(self.tree.root), [])

    def test_a_planted_upward_include_is_named_with_file_and_line(self):
        self.tree.add("src/kilter/geometry/a.cc", '\n#include "kilter/submap/ids.h"\n')
        self.assertEqual(
            check_layers.check(self.tree.root),
            ["src/kilter/geometry/a.cc:2: geometry must not look up to submap (kilter/submap/ids.h)"],
        )

    def test_a_sideways_include_is_reported(self):
        self.tree.add("src/kilter/pairing/a.h", "#  include <kilter/matching/match.h>\n")
        self.assertIn("pairing must not look sideways to matching", check_layers.check(self.tree.root)[0])

    def test_base_lies_below_its_neighbours_of_the_ground_floor(self):
        self.tree.add("src/kilter/base/a.h", '#include "kilter/geometry/pose3.h"\n')
        self.tree.add("src/kilter/numerics/a.h", '#include "kilter/base/expected.h"\n')
        self.assertEqual(len(check_layers.check(self.tree.root)), 1)

    def test_a_folder_that_no_floor_knows_is_reported(self):
        self.tree.add("src/kilter/utils/a.h", "\n")
        self.assertIn("'utils' is not in layers.toml", check_layers.check(self.tree.root)[0])

    def test_an_include_of_a_module_that_no_floor_knows_is_reported(self):
        self.tree.add("src/kilter/io/a.cc", '#include "kilter/helpers/a.h"\n')
        self.assertIn("'helpers' is not in layers.toml", check_layers.check(self.tree.root)[0])

    def test_only_tests_may_include_the_scenes_of_testing(self):
        self.tree.add("src/kilter/io/a_test.cc", '#include "testing/scene.h"\n')
        self.tree.add("src/kilter/io/a.cc", '#include "testing/scene.h"\n')
        self.assertEqual(len(check_layers.check(self.tree.root)), 1)

    def test_an_upward_link_is_reported_like_an_upward_include(self):
        self.tree.add("src/kilter/occupancy/CMakeLists.txt", "kilter_module(occupancy\n USES base submap\n LINKS io)\n")
        self.assertEqual(
            check_layers.check(self.tree.root),
            ["src/kilter/occupancy/CMakeLists.txt: occupancy must not look up to submap (USES)"],
        )

    def test_the_drawing_in_the_architecture_document_is_the_one_that_is_checked(self):
        drawing = check_layers.draw(check_layers.read_floors(ROOT))
        block = "\n".join(f"    {line}" for line in drawing.splitlines())
        self.assertIn(block, (ROOT / "ARCHITECTURE.md").read_text(encoding="utf-8"))


if __name__ == "__main__":
    unittest.main(argv=[os.path.basename(__file__), "-v"])
