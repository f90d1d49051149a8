"""Rest and steady windows of a run: by hand where the run file says so, else from the motion."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from tethertest.conditioning.stated import STANDS_STILL, half_range
from tethertest.errors import DataError
from tethertest.records.channel import Channel, Finding, Severity, Window
from tethertest.records.run import Run, Span
from tethertest.signal.settling import settled_from
from tethertest.signal.windows import FEWEST_CYCLES, SHORTEST_REST, Steady, find_rest, find_steady

#: kinds that show the motion, the best first
MOTION_KINDS = ("displacement", "tension", "wavelength")
#: a steady window set by hand may reach this far beyond the record [s]
OUTSIDE = 0.05
#: a steady window that is found stays so far inside the tensions [s], where the comparison's low-pass ends
RECORD_END = 0.1
#: share of a cycle that a whole number of them may lack
WHOLE = 1e-6
#: a record that lacks more than this share of its samples is told to do so where no drive is found in it
TOLD_MISSING = 0.01


@dataclass(frozen=True, slots=True)
class RunWindows:
    """The windows of a run on its own clock."""

    rest_before: Window | None
    rest_after: Window | None
    steady: Window | None
    findings: tuple[Finding, ...] = ()  #: about windows set by hand


def windows_of(
    run: Run, channels: Sequence[Channel], frequency: float | None, motion_reach: float = 0.0
) -> RunWindows:
    """Return the run's windows.

    Parameters
    ----------
    run : Run
        Windows set by hand win over those found.
    channels : sequence of Channel
        Channels on the run's clock; the bottom displacement shows the motion best, else a tension.
    frequency : float or None
        Drive frequency [Hz]; None takes the run file's.
    motion_reach : float
        The steady window stays so far inside the record of the motion [s], within which no replay can follow
        it, and inside the tensions by the reach of their low-pass.

    Raises
    ------
    DataError
        No rest window, a window set by hand beside the record, or a drive that the run file names and the
        record does not show.
    """
    motion = _motion(channels)
    rest = find_rest(motion)
    by_hand = run.file.windows
    reason = f"set by hand: {by_hand.reason or 'no reason given'}"
    found = f"found in {motion.name}"
    findings = _check_by_hand(run, channels, motion)
    before = _window(by_hand.rest_before, reason) or _window(rest.before, found)
    after = _window(by_hand.rest_after, reason) or _window(rest.after, found)
    if before is None and after is None:
        message = f"no rest window: {motion.name} moves from the first to the last sample"
        remedy = (
            "set [windows] rest_before or rest_after in run.toml, or log a few seconds of rest with the run"
        )
        raise DataError(message, remedy, path=run.folder / "run.toml")
    drive = run.file.drive
    if drive.kind == "none":
        return RunWindows(before, after, None, findings)
    steady = _window(by_hand.steady, reason)
    if steady is None:
        nominal = frequency or drive.frequency
        span = find_steady(motion, nominal) if nominal is not None else None
        if span is None:
            raise _no_drive(run, motion, nominal, rest.amplitude)
        tension = next((channel for channel in channels if channel.kind == "tension"), None)
        if tension is not None:
            span = settled_from(tension, span)
        span = _inside(span, channels, motion, motion_reach)
        steady = Window(*span.span, f"{found}: {_words(span)}")
    return RunWindows(before, after, steady, findings)


def _inside(steady: Steady, channels: Sequence[Channel], motion: Channel, motion_reach: float) -> Steady:
    """Return the steady window away from the ends of the records that are compared in it."""
    start, stop = steady.span
    for channel in channels:
        known = channel.time[channel.usable]
        if known.size and (channel is motion or channel.kind == "tension"):
            away = motion_reach if channel is motion else RECORD_END
            start = max(start, float(known[0]) + away)
            stop = min(stop, float(known[-1]) - away)
    cycles = int((stop - start) * steady.frequency + WHOLE)
    if (start, stop) == steady.span or cycles < FEWEST_CYCLES:
        return steady
    return Steady((stop - cycles / steady.frequency, stop), steady.frequency, steady.amplitude, cycles)


def _check_by_hand(run: Run, channels: Sequence[Channel], motion: Channel) -> tuple[Finding, ...]:
    """Refuse windows set by hand that the record does not hold; find rest windows in which the base moves."""
    logged = next((channel for channel in channels if channel.kind == "tension"), motion)
    first, last = float(logged.time[0]), float(logged.time[-1])
    findings: list[Finding] = []
    for name in ("rest_before", "steady", "rest_after"):
        span = getattr(run.file.windows, name)
        if span is None:
            continue
        words = f"[windows] {name} from {span[0]:g} s to {span[1]:g} s"
        remedy = f"correct {name} or leave it out to have it found"
        inside = min(span[1], last) - max(span[0], first)
        least = span[1] - span[0] - OUTSIDE if name == "steady" else SHORTEST_REST
        if inside < least:
            message = (
                f"{words} shares {max(inside, 0.0):.3g} s with {logged.name}, logged from {first:.4g} s to "
                f"{last:.4g} s; needed {least:.3g} s"
            )
            raise DataError(message, remedy, path=run.folder / "run.toml")
        moved = half_range(motion.between(*span)) if motion.kind == "displacement" else None
        if name != "steady" and moved is not None and moved > STANDS_STILL:
            text = f"{words} is no rest: {motion.name} moves by +/-{moved:.3g} m in it; {remedy}"
            findings.append(Finding("run.toml", "no_rest", text, Severity.FATAL))
    return tuple(findings)


def _motion(channels: Sequence[Channel]) -> Channel:
    for kind in MOTION_KINDS:
        of_kind = [channel for channel in channels if channel.kind == kind and channel.usable.any()]
        if of_kind:
            return max(of_kind, key=lambda channel: int(channel.usable.sum()))
    message = "no displacement, tension or strain was logged: rest and drive cannot be found"
    raise DataError(message, "add a log of one of them to run.toml")


def _window(span: Span | None, reason: str) -> Window | None:
    return None if span is None else Window(span[0], span[1], reason)


def _words(steady: Steady) -> str:
    return f"{steady.cycles} cycles at {steady.frequency:.5g} Hz, amplitude {steady.amplitude:.4g}"


def _no_drive(run: Run, motion: Channel, nominal: float | None, amplitude: float) -> DataError:
    wanted = "a drive of unknown frequency" if nominal is None else f"a drive near {nominal:g} Hz"
    message = (
        f"no drive found: run.toml names {wanted} ({run.file.drive.kind}), {motion.name} moves by "
        f"+/-{amplitude:.3g} {motion.unit} between {motion.time[0]:.4g} s and {motion.time[-1]:.4g} s and "
        f"holds no {FEWEST_CYCLES} steady cycles of it"
    )
    missing = 1.0 - float(np.mean(motion.usable))
    if missing > TOLD_MISSING:
        message += f"; {missing:.0%} of its samples cannot be used"
    remedy = 'correct [drive] frequency, set [windows] steady, or write kind = "none"'
    return DataError(message, remedy, path=run.folder / "run.toml")
