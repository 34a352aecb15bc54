# SPDX-FileCopyrightText: The kilter authors
# SPDX-License-Identifier: BSD-3-Clause
"""What README.md says the program takes, it takes; rows that end in "(not yet)" are refused and not ignored."""

import re
import unittest

from kilter_runner import SOURCE_DIR, main, run_kilter

ROW = re.compile(r"^\| `(?P<code>[^`]+)` \| (?P<text>.*) \|$")


def rows(start: str) -> list[tuple[str, bool]]:
    """(code, exists today) of the table rows whose code begins with `start`."""
    lines = (SOURCE_DIR / "README.md").read_text(encoding="utf-8").splitlines()
    found = (ROW.match(line) for line in lines)
    return [(row["code"], not row["text"].endswith("(not yet)")) for row in found if row and row["code"].startswith(start)]


class ReadmeCommands(unittest.TestCase):
    def test_each_command_has_a_help_page_or_is_refused(self):
        commands = rows("kilter ")
        self.assertGreaterEqual(len(commands), 5)
        for code, exists in commands:
            words = [word for word in code.split()[1:] if word.islower() and word.isalpha()]
            with self.subTest(code):
                self.assertEqual(run_kilter(*words, "--help").status, 0 if exists else 2)

    def test_each_option_of_check_stands_on_its_help_page_or_does_not_yet(self):
        options = rows("--")
        self.assertGreaterEqual(len(options), 3)
        page = run_kilter("check", "--help").stdout
        for code, exists in options:
            with self.subTest(code):
                self.assertEqual(code.split()[0] in page, exists)


if __name__ == "__main__":
    main()
