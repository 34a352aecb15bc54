# SPDX-FileCopyrightText: The kilter authors
# SPDX-License-Identifier: BSD-3-Clause
"""Runs the program as a user would, for tests that drive it from outside.

    from kilter_runner import run_kilter, main

    class Check(unittest.TestCase):
        def test_a_missing_folder_is_named(self):
            run = run_kilter("check", "no/such/mission")
            self.assertEqual(run.status, 3)
            self.assertIn("no/such/mission", run.stderr)

    if __name__ == "__main__":
        main()

CMake passes the environment: KILTER_BINARY (the program), KILTER_SOURCE_DIR. `data_folder` finds the real missions,
which are not part of the repository, by KILTER_DATA or beside the source tree; tests that need them skip without.
"""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
import unittest
from dataclasses import dataclass
from pathlib import Path

SOURCE_DIR = Path(os.environ.get("KILTER_SOURCE_DIR", Path(__file__).resolve().parent.parent))
SKIPPED = 77  # what CMake takes for "every test of this file was skipped"


@dataclass(frozen=True)
class Run:
    """What one call of the program left behind."""

    status: int  # exit status as a shell shows it: 128 + n after signal n
    stdout: str
    stderr: str

    @property
    def crashed(self) -> bool:
        """Ended by a signal that no user sends: a defect whatever the input was."""
        return self.status in {128 + n for n in (signal.SIGSEGV, signal.SIGABRT, signal.SIGBUS, signal.SIGFPE, signal.SIGILL)}


def kilter_binary() -> Path:
    """The program under test."""
    return Path(os.environ.get("KILTER_BINARY", SOURCE_DIR / "build" / "kilter"))


def run_kilter(*arguments: object, timeout_s: float = 900.0, cwd: Path | None = None,
               environment: dict[str, str] | None = None) -> Run:
    """Runs `kilter arguments...` without a terminal and waits. Raises subprocess.TimeoutExpired past `timeout_s`.

    `environment` is added to the present one; NO_COLOR is set unless it says otherwise.
    """
    command = [str(kilter_binary()), *map(str, arguments)]
    merged = {**os.environ, "NO_COLOR": "1", **(environment or {})}
    done = subprocess.run(command, capture_output=True, timeout=timeout_s, cwd=cwd, env=merged,
                          stdin=subprocess.DEVNULL, check=False)
    status = done.returncode if done.returncode >= 0 else 128 - done.returncode
    return Run(status, done.stdout.decode("utf-8", "replace"), done.stderr.decode("utf-8", "replace"))


def interrupt_kilter(number: signal.Signals, *arguments: object, after: str = "", times: int = 1,
                     ignored: tuple[signal.Signals, ...] = (), timeout_s: float = 60.0) -> Run:
    """Runs the program with --verbose, sends it a signal once a message begins with `after`, and waits for its end.

    It starts with the signals `ignored`, as under nohup, and no others.
    """
    def restore() -> None:
        # A test run in the background inherits SIGINT ignored, and kilter respects that.
        for each in (signal.SIGINT, signal.SIGHUP):
            signal.signal(each, signal.SIG_IGN if each in ignored else signal.SIG_DFL)

    with subprocess.Popen([str(kilter_binary()), *map(str, arguments), "--verbose"], stdin=subprocess.DEVNULL,
                          stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, preexec_fn=restore) as run:
        lines = []
        while not lines or (lines[-1] and not lines[-1].startswith(after)):
            lines.append(run.stderr.readline())
        for _ in range(times):
            run.send_signal(number)
            time.sleep(0.01)
        stdout, stderr = run.communicate(timeout=timeout_s)
    status = run.returncode if run.returncode >= 0 else 128 - run.returncode
    return Run(status, stdout, "".join(lines) + stderr)


def data_folder(name: str) -> Path:
    """Folder of a real mission, e.g. "loop"; skips the test where the data are not at hand."""
    places = [Path(os.environ["KILTER_DATA"])] if "KILTER_DATA" in os.environ else []
    places.append(SOURCE_DIR.parent / "shared" / "data")
    for place in places:
        if (place / name).is_dir():
            return place / name
    raise unittest.SkipTest(f"real data '{name}' not found; set KILTER_DATA to the folder that holds it")


def main() -> None:
    """Runs the tests of the calling file; exit status 77 when there was nothing but skips."""
    result = unittest.main(exit=False, verbosity=2).result
    if not result.wasSuccessful():
        sys.exit(1)
    sys.exit(SKIPPED if result.testsRun > 0 and len(result.skipped) == result.testsRun else 0)
