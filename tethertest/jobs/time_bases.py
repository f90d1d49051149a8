"""What the stamps of a log are like, in numbers and in a sentence; nothing is mended here."""

from __future__ import annotations

from typing import Final

import numpy as np

from tethertest.conditioning.timestamps.logged import with_same_times
from tethertest.conditioning.timestamps.stamp_steps import Steps, steps_of
from tethertest.conditioning.timestamps.stamps import JITTER_FRACTION, look_the_same
from tethertest.jobs.bare_log import JITTER
from tethertest.records.arrays import BoolArray, FloatArray
from tethertest.records.channel import RawLog
from tethertest.records.inspected import FewStamps, TimeBase
from tethertest.signal.passes import blocks_of

#: steps off the usual one in more than this share of the rows are the logger's habit, not single gaps
HABIT: Final = 0.05
#: a step is a whole multiple of the usual one if it differs by less than this share of it
MULTIPLE: Final = 0.01
#: places named in a sentence; all are counted
PLACES: Final = 3


def time_bases(log: RawLog) -> tuple[TimeBase | FewStamps, ...]:
    """Describe the time of a log's channels, once for those that share it.

    Parameters
    ----------
    log : RawLog
        As read.

    Returns
    -------
    tuple of TimeBase or FewStamps
        Times in seconds after the log's start, counts of flags, and a sentence.
    """
    groups = with_same_times(log.channels, lambda channel: channel.time)
    with np.errstate(over="ignore"):  # stamps that are no seconds at all
        return tuple(_base(tuple(channel.name for channel in group), group[0].time) for group in groups)


def _base(names: tuple[str, ...], stamps: FloatArray) -> TimeBase | FewStamps:
    known = np.isfinite(stamps)
    time = stamps if known.all() else stamps[known]
    missing = int(stamps.size - time.size)
    first, last = (float(time.min()), float(time.max())) if time.size else (None, None)
    if first is None or last is None or time.size < 2:
        flags = {"missing_time": missing, "duplicate_time": 0, "backward_time": 0, "gap": 0}
        return FewStamps(names, stamps.size, first, last, None, None, 0, flags, _few(time.size))
    seen = steps_of(time)
    # a row in the wrong place is no hole in the record
    ordered = np.unique(time) if seen.backward.any() else time
    holes = seen.gap if ordered is time else steps_of(ordered).gap
    step = np.diff(ordered)
    repeats = seen.duplicate & ~seen.backward
    return TimeBase(
        channels=names,
        n=stamps.size,
        first=first,
        last=last,
        step=seen.step or None,
        quantum=None if seen.quantised is None else seen.quantised.quantum,
        uneven=int(np.count_nonzero(_uneven(step, seen.median))),
        flags={
            "missing_time": missing,
            "duplicate_time": int(np.count_nonzero(repeats)),
            "backward_time": int(np.count_nonzero(seen.backward)),
            "gap": int(np.count_nonzero(holes)),
        },
        text=_sentence(time, ordered, step, seen, holes, repeats, missing),
        shortest_step=float(step.min()),
        longest_step=float(step.max()),
        mean_rate=(time.size - 1) / (last - first) if last > first else None,
        jitter=seen.jitter,
    )


def _few(count: int) -> str:
    return f"{count} stamp{'' if count == 1 else 's'}, no rate"


def _uneven(step: FloatArray, usual: float) -> BoolArray:
    """Return which steps are not the usual one; stamps that repeat are told by themselves."""
    uneven = np.zeros(step.size, dtype=bool)
    for start, stop in blocks_of(step.size):
        part = step[start:stop]
        uneven[start:stop] = (np.abs(part - usual) > JITTER * usual) & (part > 0.0)
    return uneven


def _sentence(
    time: FloatArray,
    ordered: FloatArray,
    step: FloatArray,
    seen: Steps,
    holes: BoolArray,
    repeats: BoolArray,
    missing: int,
) -> str:
    if seen.median == 0.0:
        return "no stamp is later than the one before it"
    uneven = _uneven(step, seen.median)
    count, share = int(np.count_nonzero(uneven)), float(np.mean(uneven))
    said = [
        f"{time.size} stamps from {ordered[0]:.6g} to {ordered[-1]:.6g} s, every {seconds_text(seen.step)}"
    ]
    if seen.quantised is not None:
        said.append(f"stamps cut to {seconds_text(seen.quantised.quantum)}")
        if seen.quantised.pattern:
            said[-1] += f" ({look_the_same(seen.quantised)})"
    elif share > HABIT:
        rate = (time.size - 1) / float(time.max() - time.min())
        off = step[uneven]
        words = f"jittered: {count} of {step.size} steps ({100 * share:.3g} %) are not that, but "
        words += " to ".join(dict.fromkeys((seconds_text(float(off.min())), seconds_text(float(off.max())))))
        if np.all(np.abs(off / seen.median - np.round(off / seen.median)) < MULTIPLE):
            words += ", all of them whole multiples of it"
        said.append(f"{words}; the mean rate is {rate:.4g} Hz")
    elif seen.jitter > JITTER_FRACTION * seen.median:
        said.append(f"jittered by {seconds_text(seen.jitter)} (standard deviation)")
    if holes.any() and (seen.quantised is not None or len(said) == 1):
        long = int(np.argmax(step))
        longest = f"the longest {seconds_text(float(step[long]))} after {ordered[long]:.6g} s"
        said.append(f"{_number(holes, 'gap')}, {longest}")
    if repeats.any():
        said.append(f"{_number(repeats, 'stamp')} repeated, at {_places(time[repeats])}")
    if seen.backward.any():
        said.append(f"{_number(seen.backward, 'step')} backward, to {_places(time[seen.backward])}")
    if missing:
        said.append(f"{missing} rows without a stamp")
    return "; ".join(said) if len(said) > 1 else f"{said[0]}, even"


def _number(marked: BoolArray, what: str) -> str:
    count = int(np.count_nonzero(marked))
    return f"{count} {what}{'' if count == 1 else 's'}"


def _places(times: FloatArray) -> str:
    more = f" and {times.size - PLACES} more" if times.size > PLACES else ""
    return ", ".join(f"{time:.6g} s" for time in times[:PLACES]) + more


def seconds_text(value: float) -> str:
    """Return a time in s, ms or us."""
    size = abs(value)
    if size == 0.0 or size >= 1.0:
        return f"{value:.6g} s"
    return f"{1e3 * value:.4g} ms" if size >= 1e-3 else f"{1e6 * value:.4g} us"
