# SPDX-FileCopyrightText: The kilter authors
# SPDX-License-Identifier: BSD-3-Clause
"""The program is linked as something that reads files of strangers should be."""

import subprocess
import unittest

from kilter_runner import kilter_binary, main


def readelf(*options: str) -> str:
    command = ["readelf", "--wide", *options, str(kilter_binary())]
    return subprocess.run(command, capture_output=True, text=True, check=True).stdout


class Hardening(unittest.TestCase):
    def test_the_program_loads_at_a_random_address(self):
        self.assertRegex(readelf("--file-header"), r"Type:\s+DYN")

    def test_addresses_of_functions_are_bound_at_start_and_read_only_after(self):
        self.assertIn("GNU_RELRO", readelf("--program-headers"))
        self.assertRegex(readelf("--dynamic"), r"FLAGS.*NOW")

    def test_the_stack_cannot_be_executed(self):
        stack = next(line for line in readelf("--program-headers").splitlines() if "GNU_STACK" in line)
        self.assertRegex(stack, r"\sRW\s")

    def test_overrun_buffers_on_the_stack_are_noticed(self):
        self.assertIn("__stack_chk_fail", readelf("--dyn-syms"))


if __name__ == "__main__":
    main()
