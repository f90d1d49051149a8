"""A whole run: every channel's metrics, then the verdict."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from fractions import Fraction
from typing import Final

import numpy as np

from tethertest.compare.alignment import pair_with, prepare
from tethertest.compare.metrics import (
    ORDERS,
    PHASE_ORDERS,
    order_metrics,
    peak_metric,
    slack_metrics,
    sprague_geers_metrics,
)
from tethertest.compare.subject import Subject, paired, undecided
from tethertest.compare.verdict import overall, without_drive
from tethertest.records.channel import Channel, ConditionedRun, Window
from tethertest.records.comparison import Comparison, Metric
from tethertest.records.lines import ChannelLines
from tethertest.records.rig import Limits
from tethertest.signal.noise import white_noise
from tethertest.spectra.events import ZERO_UNCERTAINTY

#: kind of channel the limits of a rig apply to
LIMITED_KIND: Final = "tension"
#: kinds that are compared for information
INFORMATIVE_KIND: Final = "strain"
#: kind of the channel that drives the replay
MOTION_KIND: Final = "displacement"
#: channels that are reported even where a run lacks them
LIMITED_CHANNELS: Final = ("tension_top", "tension_bottom")


def compare(
    measured: ConditionedRun,
    replayed: Sequence[Channel],
    measured_lines: Sequence[ChannelLines],
    replayed_lines: Sequence[ChannelLines],
    limits: Limits,
    variations: Sequence[Sequence[Channel]] = (),
    static: Mapping[str, float] | None = None,
    zero_uncertainty: float = ZERO_UNCERTAINTY,
    members: Sequence[Sequence[Channel]] = (),
) -> Comparison:
    """Hold a replay against its measurement and give a verdict.

    Parameters
    ----------
    measured : ConditionedRun
        The measured side; its steady window is the one compared.
    replayed : sequence of Channel
        At the sensors' places, named like them.
    measured_lines, replayed_lines : sequence of ChannelLines
        Lines of both sides in the steady window; empty where no drive was found.
    limits : Limits
        Of the rig file. They apply to tension channels; strains inform.
    variations : sequence of sequence of Channel
        Replays on a coarser mesh: the nominal one first, then one per uncertain parameter of the rig, moved
        up by its standard uncertainty. ``u_num = |metric(replayed) - metric(nominal)|`` and
        ``u_input^2 = sum (metric(moved) - metric(nominal))^2``.
    static : mapping, optional
        Channel -> tension at rest [N], removed from both sides before Sprague-Geers; channels not named lose
        their own means.
    zero_uncertainty : float
        Of the tension channels' zero, for slack [N].
    members : sequence of sequence of Channel
        Replays of a cable that goes slack, on a coarser mesh: the nominal one first, then others of what
        nobody knows of it. ``u_slack^2`` is the mean square of ``metric(member) - metric(nominal)``.

    Returns
    -------
    Comparison
        Metrics, verdict and reasons. A metric that cannot be formed is there as undecided, with the reason.
    """
    names = [
        channel.name for channel in measured.channels if channel.kind in {LIMITED_KIND, INFORMATIVE_KIND}
    ]
    names += [name for name in LIMITED_CHANNELS if name not in names]
    drive = _drive_frequency(measured_lines)
    missing = _missing(measured, replayed, drive)
    if missing or measured.steady is None or drive is None:
        reason = f"{missing}; noise {_noise(measured)}"
        open_ones = [metric for name in names for metric in _all_undecided(measured, name, limits, reason)]
        return without_drive(open_ones, measured.findings, reason)
    metrics: list[Metric] = []
    unusable = {
        channel.name: _unusable_share(channel, measured.steady)
        for channel in measured.channels
        if channel.kind == MOTION_KIND
    }
    for name in names:
        subject = _subject(
            measured,
            name,
            replayed,
            (measured_lines, replayed_lines),
            drive,
            limits,
            variations,
            members,
            static or {},
        )
        if isinstance(subject, str):
            metrics += _all_undecided(measured, name, limits, subject)
            continue
        if subject.limited:
            unusable[name] = _unusable_share(subject.measured, subject.window)
            unusable[f"replay of {name}"] = _not_replayed_share(subject.replayed, subject.window)
            metrics.append(peak_metric(subject))
        metrics += order_metrics(subject)
        metrics += sprague_geers_metrics(subject)
        if subject.limited:
            metrics += slack_metrics(subject, zero_uncertainty)
    return overall(metrics, measured.findings, unusable)


def _subject(
    measured: ConditionedRun,
    name: str,
    replayed: Sequence[Channel],
    lines: tuple[Sequence[ChannelLines], Sequence[ChannelLines]],
    drive: float,
    limits: Limits,
    variations: Sequence[Sequence[Channel]],
    members: Sequence[Sequence[Channel]],
    static: Mapping[str, float],
) -> Subject | str:
    """Return a channel ready for its metrics, or why it cannot be compared."""
    window, own, other = measured.steady, measured.channel(name), _named(replayed, name)
    if own is None or window is None:
        return "the run has no such channel"
    if other is None:
        return "the channel was not replayed"
    band = prepare(own, window)
    if band is None:
        return f"no usable sample in the window from {window.start:g} s to {window.stop:g} s"
    pair = pair_with(band, other)
    if isinstance(pair, str):
        return f"{pair} from {window.start:g} s to {window.stop:g} s"
    moved, of_slack = (
        tuple(channel for channels in side for channel in channels if channel.name == name)
        for side in (variations, members)
    )
    return Subject(
        measured=own,
        replayed=other,
        window=window,
        drive=drive,
        pair=pair,
        measured_lines=_lines_named(lines[0], name),
        replayed_lines=_lines_named(lines[1], name),
        moved=moved,
        moved_pairs=paired(band, moved),
        members=of_slack,
        member_pairs=paired(band, of_slack),
        clock_error=max((clock.offset_error for clock in measured.clocks), default=0.0),
        static=static.get(name),
        limits=limits,
        limited=own.kind == LIMITED_KIND,
    )


def _all_undecided(measured: ConditionedRun, name: str, limits: Limits, reason: str) -> list[Metric]:
    """Return every metric a channel would have had, with the reason why it has none."""
    channel = measured.channel(name)
    limited = channel.kind == LIMITED_KIND if channel is not None else True
    unit = channel.unit if channel is not None else "N"
    none = Limits(decision=limits.decision)
    held = limits if limited else none
    amplitudes = sorted({*ORDERS, *limits.order_amplitude}, key=Fraction)
    phases = sorted({*PHASE_ORDERS, *limits.order_phase}, key=Fraction)
    rows: list[tuple[str, str, float | None]] = [("peak_tension", unit, held.peak_tension)] if limited else []
    rows += [(f"order_amplitude {order}", unit, held.order_amplitude.get(order)) for order in amplitudes]
    rows += [(f"order_phase {order}", "rad", held.order_phase.get(order)) for order in phases]
    rows += [("sprague_geers", "1", held.sprague_geers)]
    return [undecided(metric, name, unit, limit, reason) for metric, unit, limit in rows]


def _unusable_share(channel: Channel, window: Window) -> float:
    """Return the share of a window without a usable sample of the channel; rows never logged count."""
    count = np.count_nonzero(channel.between(window.start, window.stop).usable)
    return max(0.0, 1.0 - count / (channel.rate * window.length)) if channel.rate else 1.0


def _not_replayed_share(replayed: Channel, window: Window) -> float:
    """Return the share of a replay's samples in a window at which its motion is not known."""
    return 1.0 - float(np.mean(replayed.between(window.start, window.stop).usable))


def _drive_frequency(lines: Sequence[ChannelLines]) -> float | None:
    for channel_lines in lines:
        line = channel_lines.line("1")
        if line is not None:
            return line.frequency
    return None


def _missing(measured: ConditionedRun, replayed: Sequence[Channel], drive: float | None) -> str:
    if not replayed and not any(channel.kind == MOTION_KIND for channel in measured.channels):
        return "the bottom motion was not logged, so nothing was replayed; add the encoder's log to run.toml"
    if measured.steady is None:
        return "no drive: the run has no steady window"
    return "no drive: no line of it was fitted" if drive is None else ""


def _noise(measured: ConditionedRun) -> str:
    """Say what one sample of each tension channel scatters by, whatever the cable does."""
    found = [
        f"{channel.noise or white_noise(channel.values[channel.usable]):.2g} {channel.unit} in {channel.name}"
        for channel in measured.channels
        if channel.kind == LIMITED_KIND and channel.usable.any()
    ]
    return ", ".join(found) if found else "unknown, no tension channel"


def _named(channels: Sequence[Channel], name: str) -> Channel | None:
    return next((channel for channel in channels if channel.name == name), None)


def _lines_named(lines: Sequence[ChannelLines], name: str) -> ChannelLines | None:
    return next((item for item in lines if item.channel == name), None)
