"""What the run file states against what was logged: purpose and drive."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

import numpy as np

from tethertest.records.channel import Channel, ConditionedRun, Finding, Severity, Window
from tethertest.records.lines import DriveFit
from tethertest.records.run import Run

#: a stated frequency or amplitude farther than this from what was logged is a slip of the pen
STATED_FREQUENCY = 0.02
STATED_AMPLITUDE = 0.1
#: kind of the finding that the motion is not as stated
AMPLITUDE = "drive_amplitude"
#: kind of the finding that a run moves although its file says that it does not
NOT_STATED = "drive_not_stated"
#: kind of the finding that a run may not validate the rig
CALIBRATION = "calibration_run"
#: half the range of motion above which a run is driven, whatever its file says [m]
STANDS_STILL = 2e-3
#: range between these quantiles: spikes and marker taps are left out
QUANTILES = (0.005, 0.995)


def stated_findings(run: Run, measured: ConditionedRun, drive: DriveFit | None) -> tuple[Finding, ...]:
    """Return what the run file states and the logs contradict, and what its purpose forbids.

    Parameters
    ----------
    run : Run
        The run file's drive and purpose.
    measured : ConditionedRun
        Its displacement is held against the stated amplitude.
    drive : DriveFit or None
        The drive as fitted.
    """
    return tuple(_findings(run, measured, drive))


def stated_amplitude(run: Run) -> float | None:
    """Return the amplitude of the bottom motion that the run file states [m]."""
    return run.file.drive.radius or run.file.drive.amplitude


def moves_otherwise(run: Run, heave: Channel | None, steady: Window | None) -> str | None:
    """Return stated and logged amplitude of the motion in words, where one is not the other.

    Parameters
    ----------
    run : Run
        The run file's drive.
    heave : Channel or None
        The bottom displacement.
    steady : Window or None
        Where to look at it.
    """
    stated = stated_amplitude(run)
    if stated is None or heave is None or steady is None:
        return None
    moved = half_range(heave.between(steady.start, steady.stop))
    if moved is None or abs(moved / stated - 1.0) <= STATED_AMPLITUDE:
        return None
    key = "radius" if run.file.drive.radius is not None else "amplitude"
    return f"[drive] {key} is {stated:.4g} m, {heave.name} moves by +/-{moved:.4g} m"


def _findings(run: Run, measured: ConditionedRun, drive: DriveFit | None) -> Iterator[Finding]:
    if run.file.purpose == "calibration":
        text = "its purpose is calibration: a run that identified the rig cannot validate it"
        yield Finding("run.toml", CALIBRATION, text, Severity.FATAL)
    yield from _of_drive(run, measured, drive)


def _of_drive(run: Run, measured: ConditionedRun, drive: DriveFit | None) -> Iterator[Finding]:
    stated = run.file.drive
    heave = bottom_displacement(measured.channels)
    if stated.kind == "none":
        moved = None if heave is None else half_range(heave)
        if heave is not None and moved is not None and moved > STANDS_STILL:
            text = f'[drive] kind is "none", but {heave.name} moves by +/-{moved:.3g} m; correct [drive]'
            yield Finding("run.toml", NOT_STATED, text, Severity.FATAL)
        return
    if drive is not None and stated.frequency is not None:
        error = drive.frequency / stated.frequency - 1.0
        if abs(error) > STATED_FREQUENCY:
            text = (
                f"[drive] frequency is {stated.frequency:.4g} Hz, the drive ran at {drive.frequency:.4g} Hz"
            )
            yield Finding("run.toml", "drive_frequency", f"{text}; correct it")
    otherwise = moves_otherwise(run, heave, measured.steady)
    if heave is not None and otherwise is not None:
        text = (
            f"{otherwise}: correct it or the unit of {heave.name}; the similitude table uses the stated one"
        )
        yield Finding("run.toml", AMPLITUDE, text)


def bottom_displacement(channels: Iterable[Channel]) -> Channel | None:
    """Return the channel that shows the bottom motion, if one was logged."""
    moved = [channel for channel in channels if channel.kind == "displacement"]
    return next((channel for channel in moved if channel.at in {0.0, None}), None)


def half_range(heave: Channel) -> float | None:
    """Return half the range of a displacement [m], without its rarest values; None where it has none."""
    values = heave.values[heave.usable]
    if not values.size:
        return None
    low, high = np.quantile(values, QUANTILES)
    return 0.5 * float(high - low)
