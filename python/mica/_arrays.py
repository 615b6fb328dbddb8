"""Arrays of callers as the columns that the engine reads in place."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from mica._errors import UsageError

Numbers = NDArray[np.floating[Any]]
Columns = dict[str, "float | Numbers"]


def numbers(name: str, value: ArrayLike) -> Numbers:
    """`value` as float32 or float64 of this machine, without a copy where it is that already."""
    try:
        is_dlpack_alone = hasattr(value, "__dlpack__") and not hasattr(value, "__array__")
        array: NDArray[Any] = np.from_dlpack(value) if is_dlpack_alone else np.asarray(value)  # type: ignore[arg-type]
    except (ValueError, TypeError) as error:
        raise UsageError(f"{name}: {error}") from None
    if array.dtype.kind not in "fiu":
        raise UsageError(f"{name}: found {array.dtype}; expected float32 or float64")
    single = array.dtype.kind == "f" and array.dtype.itemsize == 4
    native: Numbers = array.astype(np.float32 if single else np.float64, copy=False)
    in_place = native.flags.aligned and all(stride % native.itemsize == 0 for stride in native.strides)
    return native if in_place else native.copy()


def vectors(name: str, value: ArrayLike, length: int) -> Numbers:
    """Vectors along the last axis."""
    array = numbers(name, value)
    if array.ndim < 1 or array.shape[-1] != length:
        raise UsageError(f"{name}: found shape {array.shape}; expected (..., {length})")
    return array


def matrices(name: str, value: ArrayLike, *, symmetric: bool) -> list[Numbers]:
    """The numbers of 2x2 matrices, row by row; of symmetric ones, which may also be given so, 3."""
    array = numbers(name, value)
    if array.ndim >= 2 and array.shape[-2:] == (2, 2):
        a, b, c, d = (array[..., i, j] for i in (0, 1) for j in (0, 1))
        if not symmetric:
            return [a, b, c, d]
        if not np.array_equal(b, c):
            raise UsageError(f"{name}: found a matrix that is not symmetric")
        return [a, b, d]
    if symmetric and array.ndim >= 1 and array.shape[-1] == 3:
        return [array[..., n] for n in range(3)]
    raise UsageError(f"{name}: found shape {array.shape}; expected (..., 2, 2)" + (" or (..., 3)" if symmetric else ""))


def split(names: Sequence[str], array: Numbers) -> dict[str, Numbers]:
    """The last axis by names."""
    return {name: array[..., n] for n, name in enumerate(names)}


def broadcast(parts: Mapping[str, Numbers]) -> tuple[tuple[int, ...], Columns]:
    """The common shape, and all parts as columns of it: views where NumPy has one."""
    try:
        shape = np.broadcast_shapes(*(part.shape for part in parts.values()))
    except ValueError:
        found = ", ".join(f"{name} {part.shape}" for name, part in parts.items())
        raise UsageError(f"queries of shapes that do not go together: {found}") from None
    return shape, {
        name: float(part) if part.ndim == 0 else np.broadcast_to(part, shape).reshape(-1)
        for name, part in parts.items()
    }


def count_of(shape: tuple[int, ...]) -> int:
    return int(np.prod(shape, dtype=np.int64))


def table(name: str, value: ArrayLike, forms: Sequence[Sequence[str]]) -> tuple[int, Columns]:
    """Rows of one of these forms, told by their number of columns."""
    array = numbers(name, value)
    expected = " or ".join(f"(rows, {len(form)}): {' '.join(form)}" for form in forms)
    if array.ndim == 2:
        for form in forms:
            if array.shape[1] == len(form):
                return array.shape[0], dict(split(form, array))
    raise UsageError(f"{name}: found shape {array.shape}; expected {expected}")


def room(name: str, out: NDArray[np.float32] | None, shape: tuple[int, ...]) -> NDArray[np.float32]:
    """Where answers go: new memory, or the caller's."""
    if out is None:
        return np.empty(shape, np.float32)
    expected = f"expected a C-contiguous, writeable array of float32 of shape {shape}"
    if not isinstance(out, np.ndarray):
        raise UsageError(f"{name}: found a {type(out).__name__}; {expected}")
    if out.shape != shape or out.dtype != np.float32 or not out.flags.c_contiguous or not out.flags.writeable:
        raise UsageError(f"{name}: found {out.dtype} of shape {out.shape}; {expected}")
    return out
