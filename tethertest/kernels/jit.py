"""The one way kernels are compiled: cached on disk where that is possible."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, ParamSpec, TypeVar, cast

import numba

P = ParamSpec("P")
R = TypeVar("R")


def compiled(function: Callable[P, R]) -> Callable[P, R]:
    """Compile a kernel; on a machine without a writable cache it is compiled anew in each process."""
    try:
        kernel: Any = numba.njit(cache=True)(function)
    except RuntimeError:  # numba found no folder to keep its cache in
        kernel = numba.njit(function)
    return cast("Callable[P, R]", kernel)
