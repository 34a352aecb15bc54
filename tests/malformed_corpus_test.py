# SPDX-FileCopyrightText: The kilter authors
# SPDX-License-Identifier: BSD-3-Clause
"""Every file of the malformed corpus (malformed/) ends as its kind says, quickly, in little memory, and leaves nothing.

`invalid` ones end with exit 3 (a configuration: 2), one message that names the file, and no output; `tolerated` ones are
read. Builds with sanitizers or coverage (KILTER_INSTRUMENTED) are slower and larger, so there only the ending counts.
"""

from __future__ import annotations

import os
import shutil
import subprocess
import tempfile
import unittest
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from kilter_runner import kilter_binary, main
from malformed import write
from malformed.case import Case
from tiny_mission import TinyMission

INSTRUMENTED = "KILTER_INSTRUMENTED" in os.environ
LONGEST_S = 60.0 if INSTRUMENTED else 1.0
FREE_BYTES = 256 << 20
FEWEST = 400  # files over all formats


@dataclass(frozen=True)
class Ending:
    status: int
    message: str
    seconds: float
    peak_bytes: int


def run_measured(arguments: list[object]) -> Ending:
    """As run_kilter, with the CPU time and the peak memory of this one process."""
    with tempfile.TemporaryFile() as said:
        child = subprocess.Popen([str(kilter_binary()), *map(str, arguments)], stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL,
                                 stderr=said, env={**os.environ, "NO_COLOR": "1"})
        _, status, usage = os.wait4(child.pid, 0)
        child.returncode = os.waitstatus_to_exitcode(status)
        said.seek(0)
        return Ending(child.returncode, said.read().decode("utf-8", "replace"), usage.ru_utime + usage.ru_stime,
                      usage.ru_maxrss * 1024)


def size_of(source: Path) -> int:
    return sum(file.stat().st_size for file in ([source] if source.is_file() else source.rglob("*")))


class MalformedCorpus(unittest.TestCase):
    @classmethod
    def setUpClass(cls) -> None:
        cls.tiny = cls.enterClassContext(TinyMission())
        cls.root = cls.tiny.folder / "corpus"
        cls.out = cls.tiny.folder / "out.html"  # a folder for check, a page for report
        cls.mission = cls.tiny.copy("good")  # robot a with three scans
        cls.cases = [(case, case.write(cls.root)) for case in write.all_cases()]

    def arguments(self, case: Case, source: Path) -> list[object]:
        if case.format == "archive":
            return ["report", source, "-o", self.out]
        if case.format == "cuts":
            return ["check", self.mission, "--cuts", source, "-o", self.out]
        if case.format == "config":
            return ["check", self.mission, "--config", source, "-o", self.out]
        return ["check", source, "-o", self.out]

    def objections(self, case: Case, source: Path, ending: Ending) -> Iterator[str]:
        if ending.seconds > LONGEST_S:
            yield f"it took {ending.seconds:.1f} s"
        if not INSTRUMENTED and ending.peak_bytes > FREE_BYTES + 4 * size_of(source):
            yield f"it took {ending.peak_bytes >> 20} MB"
        if any(ord(c) < 32 and c != "\n" or ord(c) == 127 for c in ending.message):
            yield "bytes of the file reach the terminal"
        if case.tolerated:
            if ending.status not in (0, 1, 4):
                yield f"it ended with {ending.status}: {ending.message}"
            return
        expected = 2 if case.format == "config" else 3
        if ending.status != expected:
            yield f"it ended with {ending.status}, not {expected}: {ending.message}"
            return
        if self.out.exists():
            yield "something was written"
        if case.name not in ending.message:
            yield f"the message does not name the file: {ending.message}"
        if sum(not line.startswith((" ", "note:")) for line in ending.message.splitlines()) != 1:
            yield f"expected one message: {ending.message}"
        if "\n  try: " not in ending.message:
            yield f"expected the message to say what to try: {ending.message}"

    def test_every_file_ends_as_its_kind_says(self) -> None:
        self.assertGreaterEqual(len(self.cases), FEWEST)
        for case, source in self.cases:
            with self.subTest(format=case.format, name=case.name, tolerated=case.tolerated):
                ending = run_measured(self.arguments(case, source))
                faults = list(self.objections(case, source, ending))
                if self.out.is_dir():
                    shutil.rmtree(self.out)
                else:
                    self.out.unlink(missing_ok=True)
                self.assertEqual(faults, [])


if __name__ == "__main__":
    main()
