"""Rows at a scheme's own time levels, read at the output times."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from tethertest.records.arrays import FloatArray
from tethertest.records.scene import Output
from tethertest.solver.solution import Solution


def resampled(solution: Solution, output: Output) -> Solution:
    """Return a smooth solution on equal time levels at the output times, by a cubic through four levels."""
    rows = math.floor(output.duration * output.rate + 1e-9) + 1
    time = np.arange(rows) / output.rate
    step = float(solution.time[1])
    first = np.clip(np.floor(time / step).astype(np.int64) - 1, 0, solution.time.size - 4)
    weights = _weights(time / step - first)

    def read(values: FloatArray) -> FloatArray:
        shape = (-1,) + (1,) * (values.ndim - 1)
        return np.asarray(sum(weights[i].reshape(shape) * values[first + i] for i in range(4)))

    return replace(
        solution,
        time=time,
        tension=read(solution.tension),
        strain=read(solution.strain),
        platform_position=read(solution.platform_position),
        fields={name: read(values) for name, values in solution.fields.items()},
    )


def _weights(x: FloatArray) -> list[FloatArray]:
    """Return Lagrange's weights of the levels 0, 1, 2, 3 at ``x``."""
    a, b, c = x - 1.0, x - 2.0, x - 3.0
    return [-a * b * c / 6.0, x * b * c / 2.0, -x * a * c / 2.0, x * a * b / 6.0]
