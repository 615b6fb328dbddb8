"""Pictures in memory."""

from __future__ import annotations

import os
import tempfile
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, DTypeLike, NDArray

from mica import _mica
from mica._arrays import numbers
from mica._errors import UsageError


class Image(Mapping[str, NDArray[np.float32]]):
    """A picture: named channels, `image["R"]` and so on, each (height, width) float32 with rows from the top.

    The arrays are views of `image.pixels`, and may be written to. A notebook shows the picture.

    Args:
        channels: arrays of one shape by their names.
        metadata: texts to write with it.

    Attributes:
        pixels: (height, width, channels) float32.
        metadata: dict of texts: version, job, frame, device, audit.
        notes: what was assumed when it was made, and what that cost.
        exposure: of its preview, in stops.
        tone_map: of its preview: "clamp", "shoulder", "reinhard" or "filmic".

    Raises:
        UsageError: for no channels, and channels of several shapes.
    """

    def __init__(self, channels: Mapping[str, ArrayLike], metadata: Mapping[str, str] | None = None) -> None:
        arrays = {name: numbers(name, array) for name, array in channels.items()}
        shapes = {array.shape for array in arrays.values()}
        if len(shapes) != 1 or len(shape := shapes.pop()) != 2 or 0 in shape:
            found = ", ".join(f"{name} {array.shape}" for name, array in arrays.items()) or "none"
            raise UsageError(f"channels: found {found}; expected (height, width), alike for all")
        self._names = list(arrays)
        self.pixels: NDArray[np.float32] = np.stack(list(arrays.values()), axis=-1).astype(np.float32, copy=False)
        self.metadata = dict(metadata or {})
        self.notes: list[str] = []
        self.exposure = 0.0
        self.tone_map = "shoulder"

    @classmethod
    def _of(cls, image: _mica.Image) -> Image:
        made = cls.__new__(cls)
        made._names, made.pixels = image.channels, image.pixels
        made.metadata, made.notes = image.metadata, image.notes
        made.exposure, made.tone_map = image.exposure_stops, image.tone_map
        return made

    @property
    def width(self) -> int:
        """Pixels."""
        return int(self.pixels.shape[1])

    @property
    def height(self) -> int:
        """Pixels."""
        return int(self.pixels.shape[0])

    @property
    def rgb(self) -> NDArray[np.float32]:
        """(height, width, 3) float32: linear light R, G, B. Raises UsageError where a channel is missing."""
        try:
            return np.stack([self[name] for name in "RGB"], axis=-1)
        except KeyError:
            raise UsageError(f"rgb: the image has the channels {', '.join(self)}") from None

    def write(self, path: str | os.PathLike[str], exposure: float = 0.0) -> None:
        """Writes FILE.exr with all channels, or FILE.png for the eye; whole or not at all.

        Args:
            path: its ending says which.
            exposure: stops more than the image's own, of a PNG.

        Raises:
            FileError: it cannot be written.
            UsageError: for another ending or tone map.
        """
        pixels = np.ascontiguousarray(self.pixels)
        image = _mica.Image.make(pixels, self._names, self.metadata, self.exposure, self.tone_map)
        image.write(os.fsencode(path), exposure)

    def _repr_png_(self) -> bytes:
        shown = self if {"R", "G", "B"} <= set(self) else Image({self._names[0]: self[self._names[0]]})
        shown_as = Image({name: shown[name] for name in ("RGB" if shown is self else shown)})
        shown_as.exposure, shown_as.tone_map = self.exposure, self.tone_map
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "image.png"
            shown_as.write(path)
            return path.read_bytes()

    def __getitem__(self, name: str) -> NDArray[np.float32]:
        try:
            return self.pixels[..., self._names.index(name)]
        except ValueError:
            raise KeyError(name) from None

    def __iter__(self) -> Iterator[str]:
        return iter(self._names)

    def __len__(self) -> int:
        return len(self._names)

    def __array__(self, dtype: DTypeLike | None = None, copy: bool | None = None) -> NDArray[Any]:
        return np.asarray(self.pixels, dtype) if copy is None else np.array(self.pixels, dtype, copy=copy)

    def __dlpack__(self, **options: Any) -> Any:
        return self.pixels.__dlpack__(**options)

    def __dlpack_device__(self) -> tuple[int, int]:
        return self.pixels.__dlpack_device__()

    def __eq__(self, other: object) -> bool:
        return self is other  # a Mapping would ask arrays for their truth

    __hash__ = object.__hash__

    def __repr__(self) -> str:
        return f"Image({self.width} x {self.height} pixels: {', '.join(self)})"
