"""OpenCL devices."""

from __future__ import annotations

import atexit
from functools import cache

from mica import _mica
from mica._mica import DeviceInfo


def devices() -> list[DeviceInfo]:
    """Every OpenCL device, in the order in which `device=` counts them; empty when there is none.

    Each has `name`, `vendor`, `platform`, `version`, `driver`, `is_cpu`, `compute_units`, and in bytes
    `memory_bytes` in all and `buffer_bytes` of the largest single buffer.

    Raises DeviceError when a platform fails.
    """
    return _mica.devices()


@cache
def open_device(index: int) -> _mica.Device:
    """A device stays open, so that its programs are built once."""
    return _mica.Device(index)


# The collector does not look into a device, so that a module that still holds one at the end is never freed.
atexit.register(open_device.cache_clear)
