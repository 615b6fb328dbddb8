"""Answers of several numbers."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float32]


class Energy(NamedTuple):
    """What becomes of the light that a white patch receives.

    Attributes:
        single: (...) float32, the share that leaves after one bounce, towards anywhere: E1 of [Che19].
        lost: (...) float32, the share that is lost.
    """

    single: Floats
    lost: Floats


class Samples(NamedTuple):
    """Directions drawn towards the light.

    Attributes:
        light: (..., 3) float32 unit vectors in the map's tangent frame.
        pdf: (...) float32, the density of each over the sphere; 0: nothing was drawn.
        weight: (...) float32, BRDF times cosine over pdf.
    """

    light: Floats
    pdf: Floats
    weight: Floats
