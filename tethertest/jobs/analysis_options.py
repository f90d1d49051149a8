"""What a user may ask of an analysis, and whether a record can give it."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Final

from tethertest.errors import DataError
from tethertest.jobs.parse_option import FREQUENCY, parse_option
from tethertest.records.channel import Channel, Window
from tethertest.records.quantity import SI
from tethertest.records.response import NaturalFrequency

#: chance of one false line in a log, over all its channels
FALSE_LINES: Final = 0.01
#: and in a run: a campaign has tens of them, and of all of it one in fifty may have a false line
FALSE_LINES_OF_RUN: Final = 0.001
#: a drive needs this many periods in the window
FEWEST_PERIODS: Final = 3.0
#: mains frequency unless another is given [Hz]
MAINS: Final = 50.0
_TIME: Final = SI("s")


@dataclass(frozen=True, slots=True)
class Options:
    """What a user may ask of an analysis."""

    channels: tuple[str, ...] = ()  #: names; all that fit where empty
    drive_frequency: float | None = None  #: nominal [Hz]; the run file's own where absent
    window: tuple[float, float] | None = None  #: [s]; the steady window is found where absent
    natural_frequencies: tuple[float, ...] = ()  #: [Hz], beside those that a run's scene has
    mains: float = MAINS  #: [Hz]
    replay: bool = False  #: analyse the replayed channels of a run too
    rigs: Path | None = None  #: folder of rig files
    settings: tuple[str, ...] = ()  #: of a bare log, as ``KEY=VALUE``


def asked_options(
    *,
    channels: tuple[str, ...] = (),
    drive_frequency: str | None = None,
    window: str | None = None,
    naturals: tuple[str, ...] = (),
    mains: str = "50 Hz",
    replay: bool = False,
    rigs: Path | None = None,
    settings: tuple[str, ...] = (),
) -> Options:
    """Return options from texts; a bare number is in Hz or s.

    Raises
    ------
    TethertestError
        A text is no such quantity, with the option's name.
    """
    return Options(
        channels=channels,
        drive_frequency=None if drive_frequency is None else _hertz("--drive-frequency", drive_frequency),
        window=None if window is None else _span(window),
        natural_frequencies=tuple(_hertz("--natural", text) for text in naturals),
        mains=_hertz("--mains", mains),
        replay=replay,
        rigs=rigs,
        settings=settings,
    )


def _hertz(option: str, text: str) -> float:
    return parse_option(option, _with_unit(text, "Hz"), FREQUENCY)


def _span(text: str) -> tuple[float, float]:
    start, colon, stop = text.partition(":")
    if not (colon and start.strip() and stop.strip()):
        message = f"--window: found {text!r}, expected START:STOP"
        raise DataError(message, "give two times in seconds, such as --window 4:10")
    return (
        parse_option("--window", _with_unit(start, "s"), _TIME),
        parse_option("--window", _with_unit(stop, "s"), _TIME),
    )


def _with_unit(text: str, unit: str) -> str:
    """Return the text, with the unit where it is a bare number."""
    try:
        float(text)
    except ValueError:
        return text
    return f"{text.strip()} {unit}"


def window_asked(window: tuple[float, float], first: float, last: float) -> Window:
    """Return a window that a user gave, if it lies inside the record.

    Raises
    ------
    DataError
        It does not, or it ends before it starts.
    """
    start, stop = window
    if not (first <= start < stop <= last):
        message = f"--window {start:g}:{stop:g} is not inside the record, {first:.6g} to {last:.6g} s"
        raise DataError(message, "give a start and a later stop inside the record")
    return Window(start, stop, "given")


def check_drive(channel: Channel, window: Window, frequency: float) -> None:
    """Refuse a drive that a channel cannot show in a window.

    Raises
    ------
    DataError
        The frequency is not below half the channel's rate, or the window holds too few of its periods or no
        usable sample.
    """
    part = channel.between(window.start, window.stop)
    half, periods = 0.5 * channel.rate, window.length * frequency
    if frequency >= half:
        message = (
            f"channel {channel.name!r} is sampled at {channel.rate:.5g} Hz: a drive of {frequency:.4g} Hz is "
            f"not below half of that"
        )
        raise DataError(message, "give a lower --drive-frequency, or a faster log")
    if periods < FEWEST_PERIODS:
        message = (
            f"channel {channel.name!r}: {window.length:.4g} s hold {periods:.2g} periods of {frequency:.4g} "
            f"Hz, expected at least {FEWEST_PERIODS:g}"
        )
        raise DataError(message, "choose a longer window, or a longer record")
    if not part.usable.any():
        message = f"channel {channel.name!r} has no usable sample in the window"
        raise DataError(message, "choose another window, or leave the channel out")


def named_naturals(options: Options) -> tuple[NaturalFrequency, ...]:
    """Return the natural frequencies that a user gave."""
    return tuple(NaturalFrequency("given", frequency) for frequency in options.natural_frequencies)
