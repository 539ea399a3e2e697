"""Checks of arrays that callers give: what was expected, what arrived."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import DTypeLike, NDArray


def describe(dtype: DTypeLike, shape: tuple[int | str, ...]) -> str:
    """An array in words: ``float64 [N, 41, 3]``."""
    sizes = ", ".join(str(size) for size in shape)
    return f"{np.dtype(dtype).name} [{sizes}]"


def checked(name: str, array: object, dtype: DTypeLike, shape: tuple[int | str, ...]) -> NDArray[Any]:
    """``array`` itself, if it is what Rust can read in place.

    Parameters
    ----------
    name
        What the caller calls it.
    dtype
        The only dtype that is taken; nothing is converted, as that would copy.
    shape
        Sizes; a name stands for any size.

    Raises
    ------
    ValueError
        Names what was expected and what arrived.
    """
    expected = f"{name}: expected a C-contiguous array {describe(dtype, shape)}"
    if not isinstance(array, np.ndarray):
        raise ValueError(f"{expected}, got {type(array).__name__}")
    fits = array.ndim == len(shape) and all(
        isinstance(size, str) or size == actual for size, actual in zip(shape, array.shape, strict=True)
    )
    if array.dtype != np.dtype(dtype) or not fits:
        raise ValueError(f"{expected}, got {describe(array.dtype, array.shape)}")
    if not array.flags.c_contiguous:
        raise ValueError(f"{expected}, got one with strides {array.strides}: np.ascontiguousarray copies it")
    if not array.dtype.isnative or not array.flags.aligned:
        raise ValueError(f"{expected}, got one that is not aligned or of another byte order")
    return array


def output(name: str, array: object, dtype: DTypeLike, shape: tuple[int, ...]) -> NDArray[Any]:
    """As :func:`checked`, for an array that is written to."""
    array = checked(name, array, dtype, shape)
    if not array.flags.writeable:
        raise ValueError(f"{name}: expected an array that can be written to, got a read-only one")
    return array


def read_only(array: NDArray[Any]) -> NDArray[Any]:
    """``array`` itself, which cannot be written to any more."""
    array.flags.writeable = False
    return array
