"""Evaluators: questions to a surface, answered in batches."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, Literal, TypeVar

import numpy as np
from numpy.typing import ArrayLike

from mica import _mica
from mica._answers import Energy, Floats, Samples
from mica._arrays import Columns, Numbers, broadcast, count_of, matrices, numbers, room, split, table, vectors
from mica._device import open_device
from mica._errors import UsageError
from mica._map import NormalMap, Sigma
from mica._settings import method_settings
from mica._work import Progress, Report, run

Part = Literal["single", "multiple", "all"]
Handle = TypeVar("Handle", _mica.Evaluator, _mica.Brdf)

_PARTS: tuple[Part, ...] = ("single", "multiple", "all")  # as the library counts them
_QUERY = ("u", "v", "cuu", "cuv", "cvv", "s", "t")
_LOBE = ("rss", "rst", "rtt")
_TURN = ("su", "sv", "tu", "tv")
_FORMS = (_QUERY, (*_QUERY, "roughness"), (*_QUERY, *_LOBE, *_TURN))


class Evaluator:
    """Answers questions about one surface by one method, in batches on one OpenCL device.

    D(s, t) is the density of the normals that a Gaussian footprint sees, over the unit disk of half vectors, each
    normal blurred by an intrinsic roughness: [Yan14] Eq. 6. An answer depends on its question alone, to the bit,
    whatever the batch and the number of threads. Threads may share an evaluator; their calls wait for each other.

    Args:
        map: the surface; None for the method "grid", which has none (see Grid).
        ndf: the method, one of `mica.methods()`. "auto" takes the cheapest one that keeps the tolerance, and chooses by
            a sample of the first call's queries.
        tolerance: relative error to keep, of methods that take one; auto's is 0.01 unless given.
        device: its number in `mica.devices()`.
        settings: the method's own, named as in a job.

    Raises:
        UsageError: for names, settings and maps that do not fit.
        DeviceError: there is no such device, or it failed.
    """

    def __init__(
        self,
        map: NormalMap | None,
        ndf: str = "auto",
        tolerance: float | None = None,
        device: int = 0,
        **settings: Any,
    ) -> None:
        if not (map is None or isinstance(map, NormalMap)):
            raise UsageError(f"map: found a {type(map).__name__}; expected a NormalMap")
        self._map = map
        self._info = _mica.method_info(ndf)
        self._settings = {"tolerance": tolerance, **settings}
        self._device_index = device
        self._roughness = settings.get("microroughness")
        self._density_handle: _mica.Evaluator | None = None
        self._brdf_handle: _mica.Brdf | None = None
        if self._info.has_densities:
            self._densities()
        else:
            self._brdf()

    def _make(self, make: Callable[..., Handle]) -> Handle:
        handle = None if self._map is None else self._map._map
        texts = method_settings(self._settings)
        return run(lambda *_: make(open_device(self._device_index), handle, self._info.name, texts))

    def _densities(self) -> _mica.Evaluator:
        if self._density_handle is None:
            self._density_handle = self._make(_mica.Evaluator.make)
        return self._density_handle

    def _brdf(self) -> _mica.Brdf:
        if self._brdf_handle is None:
            self._brdf_handle = self._make(_mica.Brdf.make)
        return self._brdf_handle

    def _lobe(self, roughness: ArrayLike | None, lobe: ArrayLike | None = None) -> dict[str, Numbers]:
        """The columns that say how rough the surface is within a texel."""
        if roughness is None and lobe is None:
            roughness = self._roughness
        if (roughness is None) == (lobe is None):
            found = "none" if lobe is None else "a lobe besides"
            raise UsageError(f"roughness: found {found}; expected one of roughness and lobe")
        if lobe is None:
            assert roughness is not None
            return {"roughness": numbers("roughness", roughness)}
        return dict(zip(_LOBE, matrices("lobe", lobe, symmetric=True)))

    def __call__(
        self,
        uv: ArrayLike,
        cov: ArrayLike,
        half: ArrayLike,
        roughness: ArrayLike | None = None,
        *,
        turn: ArrayLike | None = None,
        lobe: ArrayLike | None = None,
        out: Floats | None = None,
        progress: Progress | None = None,
    ) -> Floats:
        """D of each query. All shapes are broadcast together; `...` is any.

        Args:
            uv: (..., 2) mean of the footprint; one period of the map is [0, 1)^2.
            cov: (..., 2, 2) its covariance, or (..., 3) cuu, cuv, cvv; uv^2 units, positive definite.
            half: (..., 2) half vector s, t on the unit disk.
            roughness: (...) standard deviation of the intrinsic Gaussian on the disk, 1e-5 to 1. A Beckmann alpha is
                sqrt(2) times this.
            turn: (..., 2, 2) how the half vector turns over the footprint: d(s, t) / d(u, v), per unit of uv.
            lobe: (..., 2, 2) or (..., 3) covariance on the disk in place of a roughness.
            out: float32 memory of the result's shape to write to.
            progress: called with (queries done, all) now and then; what it raises ends the call.

        Returns:
            float32 of the broadcast shape, finite and >= 0.

        Raises:
            UsageError: names the first query that cannot be answered; nothing is written then.
            DeviceError: the device failed.
        """
        parts = self._footprints(uv, cov) | split(("s", "t"), vectors("half", half, 2)) | self._lobe(roughness, lobe)
        if turn is not None:
            parts |= zip(_TURN, matrices("turn", turn, symmetric=False))
        shape, columns = broadcast(parts)
        return self._evaluate(shape, columns, out, progress)

    def eval(
        self,
        queries: ArrayLike,
        roughness: float | None = None,
        *,
        out: Floats | None = None,
        progress: Progress | None = None,
    ) -> Floats:
        """D of each row of a table, as of `mica eval`.

        Args:
            queries: (rows, 7) u v cuu cuv cvv s t, (rows, 8) with roughness besides, or (rows, 14) with
                rss rst rtt su sv tu tv besides.
            roughness: of all rows, where the table has none.
            out: float32 memory of shape (rows,) to write to.
            progress: called with (queries done, all) now and then.

        Returns:
            (rows,) float32.

        Raises:
            UsageError: names the first row that cannot be answered; nothing is written then.
            DeviceError: the device failed.
        """
        count, columns = self._table(queries, roughness)
        return self._evaluate((count,), columns, out, progress)

    def error(self, queries: ArrayLike, densities: ArrayLike, roughness: float | None = None) -> Floats:
        """How far each density may be off: an estimate by "auto", "triangles" and "reference".

        Args:
            queries: a table as of `eval`.
            densities: (rows,) the answers to it.
            roughness: of all rows, where the table has none.

        Returns:
            (rows,) float32, in the density's units. Of "auto" it follows from the relative L2, at 95% confidence, of
            the query's class of size and roughness (see `choices`).

        Raises:
            UsageError: the method does not tell.
        """
        count, columns = self._table(queries, roughness)
        answers = np.ascontiguousarray(numbers("densities", densities), np.float32)
        if answers.shape != (count,):
            raise UsageError(f"densities: found shape {answers.shape}; expected ({count},)")
        errors = np.empty(count, np.float32)
        self._densities().estimate_errors(count, columns, answers, errors)
        return errors

    def _table(self, queries: ArrayLike, roughness: float | None) -> tuple[int, Columns]:
        count, columns = table("queries", queries, _FORMS)
        if "rss" not in columns and "roughness" not in columns:
            columns |= broadcast(self._lobe(roughness))[1]
        return count, columns

    def _evaluate(
        self, shape: tuple[int, ...], columns: Columns, out: Floats | None, progress: Progress | None
    ) -> Floats:
        evaluator, densities, count = self._densities(), room("out", out, shape), count_of(shape)

        def work(cancellation: _mica.CancellationToken, report: Report | None) -> None:
            evaluator.evaluate(count, columns, densities.reshape(-1), cancellation, report)

        run(work, progress)
        return densities

    def pndf(
        self,
        centers: ArrayLike,
        sigma: Sigma,
        roughness: ArrayLike,
        size: int = 256,
        *,
        window: tuple[float, float, float] = (0, 0, 1),
        out: Floats | None = None,
        progress: Progress | None = None,
    ) -> Floats:
        """Whole P-NDFs as images, as of `mica ndf --centers`.

        Args:
            centers: (n, 2) means uv of the footprints.
            sigma: their standard deviation in texels, or (texels, texels, degrees): NormalMap.covariance.
            roughness: of all, or (n,) of each.
            size: pixels a side, 1 to 8192.
            window: the part of the disk that is shown: its centre s, t and half its side.
            out: float32 memory of the result's shape to write to, such as a part of an `np.memmap`.
            progress: called with (images done, all) now and then.

        Returns:
            (n, size, size) float32: D at the centres of pixels, rows from the top (t = 1), s to the right; 0 off the
            disk.

        Raises:
            UsageError: names the first footprint that cannot be answered.
            DeviceError: the device failed.
        """
        if self._map is None:
            raise UsageError(f"{self._info.name} has no map, whose texels sigma counts; expected a method with one")
        uv = vectors("centers", centers, 2)
        if uv.ndim != 2:
            raise UsageError(f"centers: found shape {uv.shape}; expected (n, 2)")
        parts = self._footprints(uv, self._map.covariance(sigma)) | self._lobe(roughness)
        shape, columns = broadcast(parts)
        if shape != uv.shape[:1]:
            raise UsageError(f"roughness: found shape {np.shape(roughness)}; expected one number or ({len(uv)},)")
        evaluator, count = self._densities(), len(uv)
        images = room("out", out, (count, size, size))
        inside = [float(number) for number in window]
        if len(inside) != 3:
            raise UsageError(f"window: found {len(inside)} numbers; expected s, t, radius")

        def work(cancellation: _mica.CancellationToken, report: Report | None) -> None:
            evaluator.draw(count, columns, inside, size, images.reshape(-1), cancellation, report)

        run(work, progress)
        return images

    def brdf(
        self,
        uv: ArrayLike,
        cov: ArrayLike,
        view: ArrayLike,
        light: ArrayLike,
        roughness: ArrayLike | None = None,
        *,
        part: Part = "all",
        progress: Progress | None = None,
    ) -> Floats:
        """f(o, i) times the light's cosine, without Fresnel's factor; of methods with a BRDF of their own.

        Args:
            uv, cov, roughness: as of a query for a density.
            view: (..., 3) direction o towards the eye in the map's tangent frame, z along the geometric normal, of any
                length but 0.
            light: (..., 3) direction i towards the light.
            part: light that bounced once ("single"), more often ("multiple"), or both.
            progress: called with (queries done, all) now and then.

        Returns:
            float32 of the broadcast shape.

        Raises:
            UsageError: the method has no BRDF, or a query cannot be answered, which is named.
            DeviceError: the device failed.
        """
        if part not in _PARTS:
            raise UsageError(f"part: found {part!r}; expected one of {', '.join(_PARTS)}")
        chosen = _PARTS.index(part)
        parts = self._views(uv, cov, view, roughness) | split(("ix", "iy", "iz"), vectors("light", light, 3))
        shape, columns = broadcast(parts)
        brdf, count, values = self._brdf(), count_of(shape), np.empty(shape, np.float32)

        def work(cancellation: _mica.CancellationToken, report: Report | None) -> None:
            brdf.evaluate(count, columns, chosen, values.reshape(-1), cancellation, report)

        run(work, progress)
        return values

    def energy(self, uv: ArrayLike, cov: ArrayLike, view: ArrayLike, roughness: ArrayLike | None = None) -> Energy:
        """What a white patch scatters to the view at once, and what it loses; arguments and errors as of `brdf`.

        Returns:
            Energy(single, lost), each float32 of the broadcast shape.
        """
        shape, columns = broadcast(self._views(uv, cov, view, roughness))
        brdf, count, albedos = self._brdf(), count_of(shape), np.empty((*shape, 2), np.float32)

        def work(cancellation: _mica.CancellationToken, report: Report | None) -> None:
            brdf.energy(count, columns, albedos.reshape(-1), cancellation, report)

        run(work)
        return Energy(albedos[..., 0], albedos[..., 1])

    def sample(
        self, uv: ArrayLike, cov: ArrayLike, view: ArrayLike, roughness: ArrayLike | None = None, *, seed: int = 1
    ) -> Samples:
        """Directions towards the light, drawn by what the footprint does to it; arguments and errors as of `brdf`.

        Args:
            seed: draw n of a seed is always the same.

        Returns:
            Samples(light, pdf, weight), float32.
        """
        if not 0 <= seed < 2**64:
            raise UsageError(f"seed: found {seed}; expected a whole number from 0, below 2^64")
        shape, columns = broadcast(self._views(uv, cov, view, roughness))
        brdf, count, samples = self._brdf(), count_of(shape), np.empty((*shape, 5), np.float32)

        def work(cancellation: _mica.CancellationToken, report: Report | None) -> None:
            brdf.sample(count, columns, seed, samples.reshape(-1), cancellation, report)

        run(work)
        return Samples(samples[..., :3], samples[..., 3], samples[..., 4])

    def _footprints(self, uv: ArrayLike, cov: ArrayLike) -> dict[str, Numbers]:
        return split(("u", "v"), vectors("uv", uv, 2)) | dict(
            zip(("cuu", "cuv", "cvv"), matrices("cov", cov, symmetric=True))
        )

    def _views(self, uv: ArrayLike, cov: ArrayLike, view: ArrayLike, roughness: ArrayLike | None) -> dict[str, Numbers]:
        directions = split(("ox", "oy", "oz"), vectors("view", view, 3))
        return self._footprints(uv, cov) | directions | self._lobe(roughness)

    @property
    def ndf(self) -> str:
        """The method's name."""
        return self._info.name

    @property
    def map(self) -> NormalMap | None:
        """The surface, which lives as long as the evaluator."""
        return self._map

    @property
    def choices(self) -> list[str]:
        """What "auto" chose so far, a line for each class of queries."""
        return [] if self._density_handle is None else self._density_handle.choices

    @property
    def bytes(self) -> int:
        """Memory of what was built on the device."""
        handles: list[Any] = [self._density_handle, self._brdf_handle]
        return sum(handle.device_bytes for handle in handles if handle is not None)

    def __repr__(self) -> str:
        about = [repr(self.ndf)] + ([] if self._map is None else [f"{self._map.width} x {self._map.height} texels"])
        about += [f"{key}={value!r}" for key, value in self._settings.items() if value is not None]
        return f"{type(self).__name__}({', '.join(about)}; {self.bytes / 2**20:.1f} MiB on device {self._device_index})"
