"""The one way kernels are compiled: cached on disk where that is possible."""

from __future__ import annotations

import hashlib
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any, ParamSpec, TypeVar, cast

import numba

P = ParamSpec("P")
R = TypeVar("R")


def compiled(function: Callable[P, R]) -> Callable[P, R]:
    """Compile a kernel; on a machine without a writable cache it is compiled anew in each process.

    A cached kernel holds the kernels that it calls, but numba looks only at its own file to see whether it is
    stale. So the name it is cached under carries a digest of all kernels.
    """
    name = function.__qualname__
    function.__qualname__ = f"{name}-{_digest()}"
    try:
        kernel: Any = numba.njit(cache=True, nogil=True)(function)
    except RuntimeError:  # numba found no folder to keep its cache in
        kernel = numba.njit(nogil=True)(function)
    finally:
        function.__qualname__ = name
    kernel.__qualname__ = name
    return cast("Callable[P, R]", kernel)


@cache
def _digest() -> str:
    sources = sorted(Path(__file__).parent.glob("*.py"))
    return hashlib.sha256(b"".join(source.read_bytes() for source in sources)).hexdigest()[:12]
