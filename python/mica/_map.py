"""Maps of normals."""

from __future__ import annotations

import math
import os
from collections.abc import Sequence
from typing import Any, Literal, Self

import numpy as np
from numpy.typing import ArrayLike, DTypeLike, NDArray

from mica import _mica
from mica._arrays import numbers
from mica._errors import UsageError
from mica._settings import surface_settings
from mica._work import run

Interpolation = Literal["nearest", "bilinear", "bicubic"]
Sigma = float | Sequence[float]

_INTERPOLATIONS: tuple[Interpolation, ...] = ("nearest", "bilinear", "bicubic")  # as the library counts them


class NormalMap:
    """A periodic map of normals.

    A normal n is kept as its projection (s, t) = (n_x, n_y) on the unit disk, x along +u, y along +v, z along the
    geometric normal. Row j of the array, counted from the bottom of the picture, and column i are the texel whose
    centre is at uv ((i + 0.5) / width, (j + 0.5) / height). A picture's rows run from the top: pass `picture[::-1]`.

    Args:
        normals: (height, width, 2) projections s, t inside the unit disk, or (height, width, 3) vectors x, y, z of
            any length but 0, z > 0. float32 and float64 are read in place, other numbers are converted.
        interpolation: between texels: "nearest", "bilinear" or "bicubic" (Catmull-Rom).

    Raises:
        UsageError: for other shapes and types, and for a normal that is none, named by its texel.
    """

    def __init__(self, normals: ArrayLike, interpolation: Interpolation = "bilinear") -> None:
        if interpolation not in _INTERPOLATIONS:
            raise UsageError(f"interpolation: found {interpolation!r}; expected one of {', '.join(_INTERPOLATIONS)}")
        array = np.ascontiguousarray(numbers("normals", normals))
        kind = _INTERPOLATIONS.index(interpolation)
        self._map = run(lambda *_: _mica.NormalMap.from_normals(array, kind))

    @classmethod
    def _of(cls, map: _mica.NormalMap) -> Self:
        made = cls.__new__(cls)
        made._map = map
        return made

    @classmethod
    def load(
        cls,
        path: str | os.PathLike[str],
        *,
        encoding: Literal["unorm", "signed", "height", "slope"] | None = None,
        green: Literal["up", "down"] | None = None,
        interpolation: Interpolation | None = None,
        channels: str | Sequence[str] | None = None,
        **settings: Any,
    ) -> Self:
        """Reads a map from a picture; docs/files.md says from which.

        Args:
            path: EXR, PNG, TIFF and what else OpenImageIO reads.
            encoding: what a pixel says; unless given it follows from the file's type, and `notes` say what was taken.
            green: whether green grows with v.
            interpolation: "bilinear" unless given.
            channels: which of the file's channels are meant.
            settings: more keys of a job's [surface]: `invalid`, `height_scale`, `part`.

        Raises:
            FileError: the file is missing, damaged or has invalid texels.
            UsageError: a setting is wrong, or does not fit the file.
        """
        named = {"encoding": encoding, "green": green, "interpolation": interpolation, "channels": channels}
        texts = surface_settings({**named, **settings})
        return cls._of(run(lambda *_: _mica.NormalMap.load(os.fsencode(path), texts)))

    @classmethod
    def generate(cls, kind: str, **settings: Any) -> Self:
        """Synthesises a map; the same settings give the same bits.

        Args:
            kind: "spectrum", "flakes", "scratches", "brushed" and the other words of `generate`, docs/surfaces.md.
            settings: its keys in a job, such as `resolution` (texels a side), `seed`, `interpolation`, `rms_slope`.

        Raises:
            UsageError: for an unknown kind or key, and a value out of its range.
        """
        texts = surface_settings(settings)
        return cls._of(run(lambda *_: _mica.NormalMap.generate(kind, texts)))

    @property
    def array(self) -> NDArray[np.float64]:
        """(height, width, 2) float64: s, t of every texel; the map's own memory, read-only."""
        return self._map.normals

    @property
    def width(self) -> int:
        """Texels along u."""
        return self._map.width

    @property
    def height(self) -> int:
        """Texels along v."""
        return self._map.height

    @property
    def interpolation(self) -> Interpolation:
        """Between texels."""
        return _INTERPOLATIONS[self._map.interpolation]

    @property
    def notes(self) -> list[str]:
        """What was assumed when the map was read, and what that cost."""
        return self._map.notes

    def covariance(self, sigma: Sigma) -> NDArray[np.float64]:
        """A footprint's covariance in uv^2 units.

        Args:
            sigma: its standard deviation in texels; or those of both axes and the angle in degrees from +u to the
                first: (a, b, degrees).

        Returns:
            (2, 2) float64, the `cov` of queries.

        Raises:
            UsageError: for another number of numbers, and numbers that are not finite.
        """
        values = numbers("sigma", sigma).reshape(-1).tolist()
        if len(values) not in (1, 3) or not all(map(math.isfinite, values)):
            raise UsageError(f"sigma: found {sigma}; expected texels, or (texels, texels, degrees)")
        major, minor, degrees = values if len(values) == 3 else (values[0], values[0], 0.0)
        angle = degrees * math.pi / 180
        a = (major * math.cos(angle) * (1.0 / self.width), major * math.sin(angle) * (1.0 / self.height))
        b = (minor * -math.sin(angle) * (1.0 / self.width), minor * math.cos(angle) * (1.0 / self.height))
        return np.array([[a[i] * a[j] + b[i] * b[j] for j in (0, 1)] for i in (0, 1)])

    def __array__(self, dtype: DTypeLike | None = None, copy: bool | None = None) -> NDArray[Any]:
        return np.asarray(self.array, dtype) if copy is None else np.array(self.array, dtype, copy=copy)

    def __dlpack__(self, **options: Any) -> Any:
        return self.array.copy().__dlpack__(**options)  # who receives it may write to it

    def __dlpack_device__(self) -> tuple[int, int]:
        return self.array.__dlpack_device__()

    def __reduce__(self) -> tuple[type[NormalMap], tuple[NDArray[np.float64], Interpolation]]:
        return type(self), (np.array(self.array), self.interpolation)

    def __repr__(self) -> str:
        return f"NormalMap({self.width} x {self.height} texels, {self.interpolation})"
