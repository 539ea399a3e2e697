"""Validation of array arguments."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import DTypeLike, NDArray


def describe(dtype: DTypeLike, shape: tuple[int | str, ...]) -> str:
    """Describes an array type, as in ``float64 [N, 41, 3]``."""
    sizes = ", ".join(str(size) for size in shape)
    return f"{np.dtype(dtype).name} [{sizes}]"


def checked(name: str, array: object, dtype: DTypeLike, shape: tuple[int | str, ...]) -> NDArray[Any]:
    """Returns ``array`` if Rust code can read it in place.

    Parameters
    ----------
    name
        Name of the argument, for messages.
    dtype
        Required dtype. Arrays are not converted, because that would copy them.
    shape
        Required sizes; a string matches any size.

    Raises
    ------
    ValueError
        If the array does not match; the message states the expected and the actual type.
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
        raise ValueError(f"{expected}, got one with strides {array.strides}; copy it with np.ascontiguousarray")
    if not array.dtype.isnative or not array.flags.aligned:
        raise ValueError(f"{expected}, got one that is not aligned or of another byte order")
    return array


def output(name: str, array: object, dtype: DTypeLike, shape: tuple[int, ...]) -> NDArray[Any]:
    """Like :func:`checked`, but also requires the array to be writeable."""
    array = checked(name, array, dtype, shape)
    if not array.flags.writeable:
        raise ValueError(f"{name}: expected a writeable array, got a read-only one")
    return array


def read_only(array: NDArray[Any]) -> NDArray[Any]:
    """Makes ``array`` read-only and returns it."""
    array.flags.writeable = False
    return array
