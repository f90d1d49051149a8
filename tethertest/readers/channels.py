"""Names and units of the channels of a log, the last step of every reader."""

from __future__ import annotations

from collections.abc import Collection, Iterable
from dataclasses import replace
from pathlib import Path
from typing import Final

import numpy.typing as npt

from tethertest.errors import FileFormatError
from tethertest.records.arrays import frozen
from tethertest.records.channel import RawChannel
from tethertest.records.run import Log

#: optical interrogators see the bands O to U; values in there are wavelengths [nm]
INTERROGATOR_BAND: Final = (1260.0, 1680.0)


def raw_channel(name: str, unit: str, time: npt.ArrayLike, values: npt.ArrayLike) -> RawChannel:
    """Return a channel whose arrays are read-only float64."""
    return RawChannel(name, unit, frozen(time), frozen(values))


def unique_names(names: Iterable[str]) -> tuple[tuple[str, ...], tuple[str, ...]]:
    """Return the names, numbered where the file repeats one, and a remark on each change."""
    seen: dict[str, int] = {}
    unique: list[str] = []
    remarks: list[str] = []
    for name in names:
        seen[name] = seen.get(name, 0) + 1
        if seen[name] == 1:
            unique.append(name)
        else:
            unique.append(f"{name} ({seen[name]})")
            remarks.append(f"the name {name!r} is used again; the later channel is called {unique[-1]!r}")
    return tuple(unique), tuple(remarks)


def with_units(
    path: Path, channels: Iterable[RawChannel], settings: Log, others: Collection[str] = ()
) -> tuple[RawChannel, ...]:
    """Return the channels with the units that the run file gives.

    Parameters
    ----------
    path : Path
        The log, for messages.
    channels : iterable of RawChannel
        As read.
    settings : Log
        Its `units` are taken where the name is a channel's.
    others : collection of str
        Further names of the file that may have a unit, such as the time column.

    Raises
    ------
    FileFormatError
        The settings name a channel that the file has not.
    """
    found = tuple(channels)
    units = settings.units
    known = {channel.name for channel in found} | set(others)
    for name in units:
        if name not in known:
            message = f"run.toml gives a unit for {name!r}, which the log does not have"
            raise FileFormatError(message, f"use one of {', '.join(sorted(known))}", path=path)
    return tuple(
        replace(channel, unit=units[channel.name]) if channel.name in units else channel for channel in found
    )
