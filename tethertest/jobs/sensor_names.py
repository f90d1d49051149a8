"""Channels of a log -> sensors of a rig, by their names and units."""

from __future__ import annotations

import re
from dataclasses import dataclass, field

from tethertest.errors import QuantityError
from tethertest.records.channel import RawChannel, RawLog
from tethertest.records.rig import Rig, Sensor
from tethertest.units import channel_scale

#: what a sensor's channel may be logged as
KINDS = {
    "tension": {"tension", "ratio", "voltage", "count"},
    "wavelength": {"wavelength"},
    "temperature": {"temperature", "wavelength"},
    "displacement": {"displacement"},
}
#: words that people write for the same thing
WORDS = {
    "f": "tension", "force": "tension", "load": "tension", "cell": "tension", "lc": "tension",
    "upper": "top", "up": "top", "oben": "top", "lower": "bottom", "base": "bottom", "unten": "bottom",
    "bot": "bottom", "position": "heave", "pos": "heave", "height": "heave", "displacement": "heave",
    "crank": "heave", "encoder": "heave", "temperature": "temp", "t": "temp",
}  # fmt: skip


@dataclass(frozen=True, slots=True)
class Matched:
    """What is known of a log's channels."""

    same: tuple[str, ...] = ()  #: channels with a sensor's own name
    guessed: dict[str, str] = field(default_factory=dict)  #: channel -> sensor of a similar name
    unknown: tuple[str, ...] = ()  #: channels of no sensor, with their units
    peaks: int = 0  #: numbered peaks, which need no name
    no_unit: tuple[str, ...] = ()  #: channels of sensors, without a unit in the file

    @property
    def count(self) -> int:
        """How many channels have a sensor."""
        return len(self.same) + len(self.guessed) + self.peaks


def matched(log: RawLog, rig: Rig | None) -> Matched:
    """Return which sensor each channel of a log belongs to, as far as names and units tell.

    Parameters
    ----------
    log : RawLog
        As read.
    rig : Rig or None
        Its sensors.
    """
    if rig is None:
        return Matched(unknown=tuple(_words(channel) for channel in log.channels))
    by_name = {sensor.name: sensor for sensor in rig.sensor}
    same = [channel for channel in log.channels if channel.name in by_name]
    left = [channel for channel in log.channels if channel.name not in by_name]
    free = [sensor for sensor in rig.sensor if sensor.name not in {channel.name for channel in same}]
    guessed: dict[str, str] = {}
    for channel in left:
        rated = sorted(((_likeness(channel, sensor), sensor.name) for sensor in free), reverse=True)
        if rated and rated[0][0] > 0 and (len(rated) < 2 or rated[0][0] > rated[1][0]):
            guessed[channel.name] = rated[0][1]
    repeated = [name for name in guessed.values() if list(guessed.values()).count(name) > 1]
    guessed = {channel: sensor for channel, sensor in guessed.items() if sensor not in repeated}
    rest = [channel for channel in left if channel.name not in guessed]
    peaks = [channel for channel in rest if re.match(r"CH\s*\d+ peak\d+$", channel.name)]
    return Matched(
        tuple(channel.name for channel in same),
        guessed,
        tuple(_words(channel) for channel in rest if channel not in peaks),
        len(peaks),
        tuple(item.name for item in log.channels if not item.unit.strip() and item not in rest),
    )


def _words(channel: RawChannel) -> str:
    return f"{channel.name} [{channel.unit}]"


def _likeness(channel: RawChannel, sensor: Sensor) -> int:
    """Return how many words two names share; 0 where the unit belongs to another kind of sensor."""
    if channel.unit.strip():
        try:
            kind = channel_scale(channel.unit).kind
        except QuantityError:
            return 0
        if kind not in KINDS[sensor.kind] and kind != "other":
            return 0
    return len(_parts(channel.name) & _parts(sensor.name))


def _parts(name: str) -> set[str]:
    parts = re.findall(r"[a-z]+|\d+", re.sub(r"([a-z])([A-Z])", r"\1 \2", name).lower())
    return {WORDS.get(part, part) for part in parts}
