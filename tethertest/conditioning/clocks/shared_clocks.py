"""Logs of several files that run.toml puts on one clock: whether they are on one."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from tethertest.conditioning.clocks.fitted import fitted_clock
from tethertest.conditioning.rig_priors import RigPriors
from tethertest.records.channel import Channel, ClockFit, Finding, Severity
from tethertest.records.run import Run

#: files of one clock may lie apart by this many standard errors, and by this much [s]
APART_SIGMAS, APART = 5.0, 5e-3
#: kinds by which a log can be placed by itself
PLACED = frozenset(["displacement", "wavelength"])


def shared_clock_findings(
    fit: ClockFit, channels: Sequence[Channel], reference: Sequence[Channel], run: Run, priors: RigPriors
) -> tuple[Finding, ...]:
    """Say which files of a clock are not on it, by what each of them shows by itself.

    Parameters
    ----------
    fit : ClockFit
        Of the clock; it rests on one of the files, or the clock is the reference.
    channels, reference : sequence of Channel
        Channels on that clock and on the reference clock, as `fitted_clock` takes them.
    run : Run
        The run.
    priors : RigPriors
        What the rig's mechanics says beforehand.

    Returns
    -------
    tuple of Finding
        A fatal one for each file that lies apart. A file that cannot be placed by itself is not judged.
    """
    if fit.clock in run.file.override.clock_offset:
        return ()
    files = dict.fromkeys(channel.source.file for channel in channels if channel.source)
    if len(files) < 2:
        return ()
    findings = []
    for file in files:
        own = [channel for channel in channels if channel.source and channel.source.file == file]
        if any(channel.kind == "tension" for channel in own) or not any(c.kind in PLACED for c in own):
            continue
        found, problems = fitted_clock(fit.clock, own, reference, run, priors)
        if any(item.severity == Severity.FATAL for item in problems):
            continue
        middle = float(np.mean([own[0].time[0], own[0].time[-1]]))
        apart = float(found.to_reference(np.array(middle)) - fit.to_reference(np.array(middle)))
        error = float(np.hypot(found.offset_error, fit.offset_error))
        if abs(apart) > max(APART_SIGMAS * error, APART):
            others = ", ".join(other for other in files if other != file)
            text = (
                f"{file} is not on the clock of {others}: {found.method} puts it {-apart:+.4g} s "
                f"(+/- {error:.1g}) off; give each instrument a clock of its own in run.toml"
            )
            findings.append(Finding(fit.clock, "clock_shared", text, Severity.FATAL))
    return tuple(findings)
