"""Wall times on a busy machine: medians after a warm-up."""

from __future__ import annotations

import statistics
import time
from collections.abc import Callable
from typing import TypeVar

from tethertest.solver.nonlinear.chain_march import kept_case

Answer = TypeVar("Answer")

#: repeats of a job that takes up to so long [s]
_REPEATS = ((0.5, 5), (2.5, 3))


def timed(job: Callable[[], Answer]) -> tuple[Answer, float]:
    """Return a job's answer and its median wall time [s] of 5 runs after a warm-up, fewer if it is long."""
    began = time.perf_counter()
    answer = job()
    first = time.perf_counter() - began
    repeats = next((count for longest, count in _REPEATS if first < longest), 1)
    seconds = []
    for _ in range(repeats):
        kept_case.cache_clear()  # its rest is part of the job
        began = time.perf_counter()
        answer = job()
        seconds.append(time.perf_counter() - began)
    return answer, statistics.median(seconds)
