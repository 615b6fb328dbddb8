"""Images of P-NDFs by one call."""

from __future__ import annotations

from typing import Any

from numpy.typing import ArrayLike

from mica._answers import Floats
from mica._evaluator import Evaluator
from mica._map import NormalMap, Sigma
from mica._work import Progress


def pndf(
    map: NormalMap,
    centers: ArrayLike,
    sigma: Sigma,
    roughness: ArrayLike,
    size: int = 256,
    *,
    ndf: str = "auto",
    tolerance: float | None = None,
    device: int = 0,
    window: tuple[float, float, float] = (0, 0, 1),
    out: Floats | None = None,
    progress: Progress | None = None,
    **settings: Any,
) -> Floats:
    """Whole P-NDFs as images: `Evaluator(map, ndf, tolerance, device, **settings).pndf(...)`, which says more.

    Returns:
        (n, size, size) float32: D at the centres of pixels, rows from the top (t = 1), s to the right; 0 off the
        disk.

    Raises:
        UsageError, DeviceError: as of Evaluator and of Evaluator.pndf.
    """
    evaluator = Evaluator(map, ndf, tolerance, device, **settings)
    return evaluator.pndf(centers, sigma, roughness, size, window=window, out=out, progress=progress)
