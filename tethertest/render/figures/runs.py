"""Which runs and channels figures over many runs show, and how they are named."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Final

from tethertest.records.across import Group, RunChannel, RunPart
from tethertest.records.analysis import MEASURED, REPLAYED

UNITS: Final = {"frequency": "Hz", "amplitude": "m"}
KINDS: Final = {"tension": "Tension", "strain": "Strain"}
#: settings that agree to so many digits are one
SETTING_DIGITS: Final = 3


def setting_of(part: RunPart, against: str) -> float:
    """Return a run's setting; a run of a group has one."""
    value = part.frequency if against == "frequency" else part.amplitude
    return math.nan if value is None else value


def title_of(group: Group) -> str:
    """Return what the runs of a group have in common."""
    fixed = "amplitude" if group.against == "frequency" else "frequency"
    at = "" if group.fixed is None else f", {group.fixed:.3g} {UNITS[fixed]}"
    return f"{group.rig}, {group.mode}{at}"


def named(value: float, part: RunPart, against: str) -> str:
    """Return the setting and the run as text."""
    return f"{value:.{SETTING_DIGITS}g} {UNITS[against]} ({part.run})"


def places(parts: Sequence[RunPart], kind: str) -> dict[str, float]:
    """Return the channels of a kind and where they are."""
    return {
        channel.name: -1.0 if channel.at is None else channel.at
        for part in parts
        for channel in part.channels
        if channel.kind == kind
    }


def nearest_top(parts: Sequence[RunPart], kind: str) -> str | None:
    """Return the channel of a kind that is nearest the top of the cable."""
    found = places(parts, kind)
    return max(found, key=lambda name: found[name]) if found else None


def channel_of(part: RunPart, name: str, side: str) -> RunChannel | None:
    """Return a channel of a run, if it has it."""
    return next((c for c in part.channels if c.name == name and c.side == side), None)


def has_spectrum(parts: Sequence[RunPart], name: str) -> bool:
    """Return whether any run has a spectrum of that channel."""
    found = [channel_of(part, name, side) for part in parts for side in (MEASURED, REPLAYED)]
    return any(channel is not None and channel.spectrum is not None for channel in found)


def by_setting(parts: Sequence[RunPart], against: str, name: str) -> list[RunPart]:
    """Return one run per setting, one whose channel is not damaged where there is one."""
    chosen: dict[str, RunPart] = {}
    for part in parts:
        key = f"{setting_of(part, against):.{SETTING_DIGITS}g}"
        channel = channel_of(part, name, MEASURED) or channel_of(part, name, REPLAYED)
        if channel is None or channel.spectrum is None:
            continue
        known = chosen.get(key)
        if known is None or (
            (old := channel_of(known, name, MEASURED)) and old.damage and not channel.damage
        ):
            chosen[key] = part
    return sorted(chosen.values(), key=lambda part: setting_of(part, against))
