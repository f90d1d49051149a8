"""What must hold between the keys of a scene's output, and between them and its drive."""

from __future__ import annotations

import math
from collections.abc import Iterator

from tethertest.readers.config.problems import Problem
from tethertest.records.scene import Output, Scene

#: most numbers that one response may hold; they are 400 MB
MOST_VALUES = 5e7
#: numbers of a row at each gauge: tension and strain, and what the fields add
_PLAIN_VALUES = 2
_FIELD_VALUES = {"position": 3, "velocity": 3, "curvature": 1}


#: fewest output rows per period of the drive; at two, all may lie on zeros of a sine
_ROWS_PER_PERIOD = 2.1


def output_problems(scene: Scene) -> Iterator[Problem]:
    """Yield what is wrong between the keys of a scene's output."""
    output = scene.output
    if not output.gauges:
        yield Problem(("output", "gauges"), "found no gauge", "write `gauges = [0.0, 1.0]`")
    if len({f"{gauge:g}" for gauge in output.gauges}) < len(output.gauges):
        text = "found a gauge twice (columns are named by six digits)"
        yield Problem(("output", "gauges"), text, "name every place once")
    if len(set(output.fields)) < len(output.fields):
        yield Problem(("output", "fields"), "found a field twice", "name every field once")
    yield from size_problems(output)
    rows = output.duration * output.rate
    if rows + 1e-9 < 1.0:
        text = f"found {output.rate:g} Hz, which in {output.duration:g} s gives no row but the first"
        yield Problem(("output", "rate"), text, "raise the rate or the duration")
    frequency = scene.bottom.frequency
    if frequency is not None and scene.bottom.motion in {"harmonic", "crank-slider"}:
        needed = _ROWS_PER_PERIOD * frequency
        if output.rate < needed:
            text = (
                f"found {output.rate:g} Hz, expected at least {needed:g} Hz, above twice the drive's "
                "frequency: rows so far apart would show another motion"
            )
            yield Problem(("output", "rate"), text, f'write `rate = "{20.0 * frequency:g} Hz"`, or more')


def size_problems(output: Output) -> Iterator[Problem]:
    """Yield an output that would not fit into memory."""
    per_gauge = _PLAIN_VALUES + sum(_FIELD_VALUES[name] for name in output.fields)
    values = (output.duration * output.rate + 1.0) * len(output.gauges) * per_gauge
    if not values <= MOST_VALUES:
        text = (
            f"found {output.rate:g} Hz over {output.duration:g} s at {len(output.gauges)} gauges, which "
            f"makes {values:.2g} values, expected at most {MOST_VALUES:.2g}"
        )
        possible = output.rate * MOST_VALUES / values if math.isfinite(values) else 0.0
        remedy = "lower the rate, the duration or the number of gauges or fields"
        if possible:
            remedy += f"; this duration allows {possible:.3g} Hz"
        yield Problem(("output", "rate"), text, remedy)
