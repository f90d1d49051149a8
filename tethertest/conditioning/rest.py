"""Rest and steady windows of a run: by hand where the run file says so, else from the motion."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from tethertest.errors import DataError
from tethertest.records.channel import Channel, Window
from tethertest.records.run import Run, Span
from tethertest.signal.settling import settled_from
from tethertest.signal.windows import FEWEST_CYCLES, Steady, find_rest, find_steady

#: kinds that show the motion, the best first
MOTION_KINDS = ("displacement", "tension", "wavelength")


@dataclass(frozen=True, slots=True)
class RunWindows:
    """The windows of a run on its own clock."""

    rest_before: Window | None
    rest_after: Window | None
    steady: Window | None


def windows_of(run: Run, channels: Sequence[Channel], frequency: float | None) -> RunWindows:
    """Return the run's windows.

    Parameters
    ----------
    run : Run
        Windows set by hand win over those found.
    channels : sequence of Channel
        Channels on the run's clock; the bottom displacement shows the motion best, else a tension.
    frequency : float or None
        Drive frequency [Hz]; None takes the run file's.

    Raises
    ------
    DataError
        No rest window, or a drive that the run file names and the record does not show.
    """
    motion = _motion(channels)
    rest = find_rest(motion)
    by_hand = run.file.windows
    reason = f"set by hand: {by_hand.reason or 'no reason given'}"
    found = f"found in {motion.name}"
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
        return RunWindows(before, after, None)
    steady = _window(by_hand.steady, reason)
    if steady is None:
        nominal = frequency or drive.frequency
        span = find_steady(motion, nominal) if nominal is not None else None
        if span is None:
            raise _no_drive(run, motion, nominal, rest.amplitude)
        tension = next((channel for channel in channels if channel.kind == "tension"), None)
        if tension is not None:
            span = settled_from(tension, span)
        steady = Window(*span.span, f"{found}: {_words(span)}")
    return RunWindows(before, after, steady)


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
        f"+/-{amplitude:.3g} {motion.unit} and holds no {FEWEST_CYCLES} steady cycles of it"
    )
    remedy = 'correct [drive] frequency, set [windows] steady, or write kind = "none"'
    return DataError(message, remedy, path=run.folder / "run.toml")
