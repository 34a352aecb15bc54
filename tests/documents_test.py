# SPDX-FileCopyrightText: The kilter authors
# SPDX-License-Identifier: BSD-3-Clause
"""Documents name files, presets and scripts that exist."""

import json
import os
import re
import unittest
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
DOCUMENTS = sorted([*ROOT.glob("*.md"), *(ROOT / "docs").glob("*.md")])
LINK = re.compile(r"\[[^\]]+\]\((?!https?:)(?P<path>[^)#]+)")
SHELL_BLOCK = re.compile(r"^```sh\n(?P<commands>.*?)^```", re.MULTILINE | re.DOTALL)


def shell_commands() -> list[str]:
    """Lines of all ```sh blocks, comments stripped."""
    blocks = (match["commands"] for document in DOCUMENTS
              for match in SHELL_BLOCK.finditer(document.read_text(encoding="utf-8")))
    lines = (line.split("#")[0].strip() for block in blocks for line in block.splitlines())
    return [line for line in lines if line]


class Documents(unittest.TestCase):
    def test_relative_links_lead_somewhere(self):
        for document in DOCUMENTS:
            for link in LINK.finditer(document.read_text(encoding="utf-8")):
                with self.subTest(document=document.name, link=link["path"]):
                    self.assertTrue((document.parent / link["path"]).exists())

    def test_presets_that_commands_name_exist(self):
        presets = json.loads((ROOT / "CMakePresets.json").read_text(encoding="utf-8"))
        known = {preset["name"] for preset in presets["workflowPresets"]}
        named = {command.split()[-1] for command in shell_commands() if command.startswith("cmake --workflow")}
        self.assertTrue(named)
        self.assertLessEqual(named, known)

    def test_scripts_that_commands_name_can_be_run(self):
        named = {command.split()[0] for command in shell_commands() if command.startswith("scripts/")}
        self.assertTrue(named)
        for script in named:
            self.assertTrue(os.access(ROOT / script, os.X_OK), script)


if __name__ == "__main__":
    unittest.main()
