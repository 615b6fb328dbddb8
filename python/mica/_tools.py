"""The command's own tools, run as a process of their own, so that nothing of this one is in their numbers."""

from __future__ import annotations

import json
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import Any

from mica._errors import DeviceError, Error, FileError, UsageError

_ERRORS: dict[int, type[Error]] = {2: UsageError, 3: DeviceError, 4: FileError}


def _report(*arguments: str) -> dict[str, Any]:
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "report.json"
        command = [sys.executable, "-m", "mica", *arguments, "--json", str(path)]
        done = subprocess.run(command, capture_output=True, text=True, errors="replace", check=False)
        if path.exists():
            report: dict[str, Any] = json.loads(path.read_text())
            return report
    raise _ERRORS.get(done.returncode, DeviceError)(done.stderr.strip().removeprefix("mica: "))


def bench(suite: str = "quick", *, device: int = 0) -> dict[str, Any]:
    """Measures every method's speed and error side by side: `mica bench`.

    Args:
        suite: "tiny", "quick" (less than a minute on two idle cores) or "standard" (less than ten).
        device: its number in `mica.devices()`.

    Returns:
        What `mica bench --json` writes; docs/benchmark.md says what is measured and how.

    Raises:
        UsageError: for an unknown suite.
        DeviceError: there is no such device, or it failed.
    """
    return _report("bench", suite, "--device", str(device), "--quiet")


def selftest(*, device: int = 0) -> dict[str, Any]:
    """Checks the accuracy of a device's arithmetic and of every kernel: `mica selftest`.

    Returns:
        What `mica selftest --json` writes: `pass`, whether the device is to be trusted, and each check with its
        verdict.

    Raises:
        DeviceError: there is no such device, or it failed before it was judged.
    """
    return _report("selftest", "--device", str(device))
