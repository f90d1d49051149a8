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
    """Compile a kernel; on a machine without a writable cache it is compiled anew in each process."""
    return _compiled(function)


def compiled_small(function: Callable[P, R]) -> Callable[P, R]:
    """Compile a kernel that makes no array, to be called for every few bytes or numbers of one.

    Numba counts who holds an array at every call that is handed one, which takes longer than such a kernel
    does. These count nothing and become part of their callers.
    """
    return _compiled(function, _nrt=False, forceinline=True)


def _compiled(function: Callable[P, R], **options: bool) -> Callable[P, R]:
    """Compile a function and keep what comes of it on the disk.

    A cached kernel holds the kernels that it calls, but numba looks only at its own file to see whether it is
    stale. So the name it is cached under carries a digest of all kernels.
    """
    njit: Any = numba.njit
    name = function.__qualname__
    function.__qualname__ = f"{name}-{_digest()}"
    try:
        kernel: Any = njit(cache=True, nogil=True, **options)(function)
    except RuntimeError:  # numba found no folder to keep its cache in
        kernel = njit(nogil=True, **options)(function)
    finally:
        function.__qualname__ = name
    kernel.__qualname__ = name
    return cast("Callable[P, R]", kernel)


@cache
def _digest() -> str:
    sources = sorted(Path(__file__).parent.glob("*.py"))
    return hashlib.sha256(b"".join(source.read_bytes() for source in sources)).hexdigest()[:12]
