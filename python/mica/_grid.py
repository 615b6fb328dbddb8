"""Glints without a map."""

from __future__ import annotations

from typing import Any

from mica._evaluator import Evaluator


class Grid(Evaluator):
    """Glints without a map: random ones on an implicit grid, in constant time. [Kem25]

    Takes the questions of an Evaluator. `roughness` is that of one glint; unless a call has one, it is the setting
    `microroughness`, where that is given.

    Args:
        device: its number in `mica.devices()`.
        settings: the method's, named as in a job: `density`, `alpha`, `microroughness`, `distribution`, `seed`, ...

    Raises:
        UsageError: for unknown settings, and values that they do not take.
        DeviceError: there is no such device, or it failed.
    """

    def __init__(self, *, device: int = 0, **settings: Any) -> None:
        super().__init__(None, "grid", device=device, **settings)
