"""What a finding does not rest on: an input that nobody measured, cycles that noise hides."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

from tethertest.records.analysis import ChannelAnalysis
from tethertest.records.channel import Channel
from tethertest.records.lines import ChannelLines, LineVerdict
from tethertest.signal.noise import quantum

#: load cycles are counted above noise; noise above this share of a channel's range hides some that matter
HIDES: Final = 0.1
#: noise below this share of a digit does not smooth the rounding
COARSE: Final = 0.4
#: verdicts that claim no line
NOTHING: Final = (LineVerdict.NONE, LineVerdict.NOT_RESOLVABLE)


def reservations(found: Sequence[ChannelAnalysis], *, motion: bool) -> list[str]:
    """Return what a reader of the tables must know.

    Parameters
    ----------
    found : sequence of ChannelAnalysis
        Channels with their lines and load cycles.
    motion : bool
        The bottom motion was measured, and lines were held against it.
    """
    notes = []
    named = [
        f"{item.channel.name} {line.order}"
        for item in found
        if item.lines is not None
        for line in item.lines.lines
        if line.verdict is LineVerdict.SUBHARMONIC
    ]
    if named and not motion:
        notes.append(
            f"{', '.join(named)}: no bottom motion was measured; a drive that itself moves at this order, as "
            "a worn gear or belt does, would look the same"
        )
    for item in found:
        if item.lines is not None:
            notes += _unresolved(item.lines) + _rounded(item.channel, item.lines)
        if item.cycles is None or item.extremes is None:
            continue
        width = item.extremes.maximum - item.extremes.minimum
        if item.cycles.smallest > HIDES * width:
            notes.append(
                f"{item.channel.name}: load cycles below {item.cycles.smallest:.3g} {item.channel.unit} are "
                f"not counted, {item.cycles.smallest / width:.0%} of its range: one sample's noise, or hum, "
                f"is {item.channel.noise:.2g} {item.channel.unit}; filter the log before cycles are counted"
            )
    return notes


def _unresolved(lines: ChannelLines) -> list[str]:
    """Say what a short window takes for granted."""
    window = lines.window.stop - lines.window.start
    orders = [
        line.order
        for line in lines.lines
        if line.verdict is LineVerdict.NOT_RESOLVABLE
        and line.length_needed is not None
        and line.p_value >= 1.0
    ]
    if not orders:
        return []
    return [
        f"{lines.channel}: {window:.3g} s cannot tell order {', '.join(orders)} from the others; amplitudes "
        "and intervals of the others take it as absent"
    ]


def _rounded(channel: Channel, lines: ChannelLines) -> list[str]:
    """Say which lines the digits of the log may have made: rounding without noise between is a distortion."""
    used = channel.values[channel.usable]
    digit = quantum(used)
    if not channel.noise < COARSE * digit:
        return []
    small = [
        line.order
        for line in lines.lines
        if line.order != "1" and line.verdict not in NOTHING and line.amplitude < 0.5 * digit
    ]
    if not small:
        return []
    return [
        f"{channel.name}: logged in steps of {digit:.3g} {channel.unit} with less noise than that; rounding "
        f"makes lines of up to half a step at any order, as at {', '.join(small)}"
    ]
