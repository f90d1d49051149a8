"""Zero of a channel from its rest windows, robust against taps and ringing."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from tethertest.records.channel import Channel, Finding, Flag, Severity, Window
from tethertest.signal.noise import MAD_TO_SIGMA
from tethertest.signal.passes import blocks_of

#: the level at rest is the median of means over this time: taps and ringing above 10 Hz average out [s]
BLOCK = 0.25
#: a load cell's zero may drift by this fraction of its rated load (50 mN of 100 N) before it is flagged
TENSION_DRIFT = 5e-4
#: rated load of a cell that the rig does not rate [N]
DEFAULT_RATED = 100.0
#: and a grating's zero by this strain
STRAIN_DRIFT = 2e-5
#: standard error of a median over that of a mean, for normal noise
MEDIAN_TO_MEAN = 1.2533


@dataclass(frozen=True, slots=True)
class Level:
    """Level of a channel at rest."""

    time: float  #: middle of the samples [s]
    value: float
    error: float  #: standard error


def rest_level(channel: Channel, window: Window | None) -> Level | None:
    """Return a channel's level in a rest window, None where no sample of it is usable.

    Parameters
    ----------
    channel : Channel
        On the window's clock.
    window : Window or None
        A rest window.
    """
    if window is None:
        return None
    part = channel.between(window.start, window.stop)
    values, time = part.values[part.usable], part.time[part.usable]
    if not values.size:
        return None
    size = max(round(BLOCK * channel.rate), 1)
    count = max(values.size // size, 1)
    means = np.array([block.mean() for block in np.array_split(values, count)])
    value = float(np.median(means))
    spread = MAD_TO_SIGMA * float(np.median(np.abs(means - value)))
    return Level(float(time.mean()), value, MEDIAN_TO_MEAN * spread / np.sqrt(count))


def zeroed(
    channel: Channel,
    before: Level | None,
    after: Level | None,
    expected: float,
    allowed_drift: float,
) -> tuple[Channel, tuple[Finding, ...]]:
    """Return the channel with its rest levels at the expected value.

    Parameters
    ----------
    channel : Channel
        A channel in SI.
    before, after : Level or None
        Its levels at rest; with both, a straight line of drift between them is taken out as well.
    expected : float
        Its value at rest.
    allowed_drift : float
        Drift beyond this is flagged on every sample.

    Returns
    -------
    tuple
        The channel with the step on record, and findings.
    """
    level = before or after
    if level is None:
        text = f"no usable sample at rest: its zero is unknown, the record's median is set to {expected:g}"
        value = float(np.median(channel.values[channel.usable])) if channel.usable.any() else expected
        # a grating informs; without the zero of a load cell or an encoder nothing can be decided
        severity = Severity.WARNING if channel.kind == "strain" else Severity.FATAL
        finding = Finding(channel.name, "no_tare", text, severity)
        return channel.with_values(channel.values - value + expected, text), (finding,)
    drift = after.value - before.value if before is not None and after is not None else 0.0
    elapsed = after.time - before.time if before is not None and after is not None else 1.0
    offset = level.value - expected
    values = np.empty(channel.time.size)
    for first, last in blocks_of(values.size):
        line = offset + drift * (channel.time[first:last] - level.time) / elapsed
        values[first:last] = channel.values[first:last] - line
    step = (
        f"zero offset {offset:.6g} {channel.unit} (+/- {level.error:.2g}) taken out, rest at {expected:.6g}; "
        f"drift {drift:+.3g} {channel.unit} over {elapsed:.4g} s taken out as a straight line"
    )
    # that a drift was straight is not known: at worst all of it came at once, half of it either way
    unknown = np.hypot(level.error, drift / np.sqrt(12.0))
    changed = replace(
        channel.with_values(values, step),
        offset_uncertainty=float(np.hypot(channel.offset_uncertainty, unknown)),
    )
    if abs(drift) <= allowed_drift:
        return changed, ()
    text = (
        f"zero drifts by {drift:+.3g} {channel.unit} between the rest windows, more than {allowed_drift:.3g}"
    )
    span = ((float(channel.time[0]), float(channel.time[-1])),)
    finding = Finding(channel.name, "drift", text, spans=span, samples=channel.time.size)
    return changed.with_flags(np.ones(channel.time.size, dtype=bool), Flag.DRIFT), (finding,)
