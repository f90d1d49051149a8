"""The entry that an inspected log would have in run.toml, for a person to copy and complete."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, Final

from tethertest.jobs.draft_text import TODO, quoted
from tethertest.records.channel import RawLog

#: channels named in one line; the others are counted in a comment
NAMED: Final = 6


def entry_text(log: RawLog, settings: Mapping[str, Any]) -> str:
    """Return the ``[[log]]`` table of a log that a reader has read.

    Parameters
    ----------
    log : RawLog
        As read.
    settings : mapping
        What was given to read it, as TOML has it; it must stand in run.toml too.
    """
    lines = [
        "[[log]]",
        f"file = {quoted(log.path.name)}",
        f"clock = {quoted(TODO)}  # name of the instrument in the rig file",
    ]
    names = [channel.name for channel in log.channels]
    pairs = ", ".join(f"{quoted(name)} = {quoted(TODO)}" for name in names[:NAMED])
    lines.append(f"channels = {{ {pairs} }}  # sensors of the rig{_more(names)}")
    lines += [f"{key} = {_toml(value)}" for key, value in settings.items() if key != "units"]
    units = dict(settings.get("units", {}))
    bare = [channel.name for channel in log.channels if not channel.unit and channel.name not in units]
    units |= dict.fromkeys(bare[:NAMED], TODO)
    if units:
        pairs = ", ".join(f"{quoted(name)} = {quoted(unit)}" for name, unit in units.items())
        why = f"  # the file has none{_more(bare)}" if bare else ""
        lines.append(f"units = {{ {pairs} }}{why}")
    if log.start is not None and log.start.tzinfo is None and "time_zone" not in settings:
        lines.append('# time_zone = "+08:00"  # the stamps have no zone: this, if it is not that of the run')
    return "\n".join(lines)


def _more(names: Sequence[str]) -> str:
    left = len(names) - NAMED
    return f"; and so for {left} more" if left > 0 else ""


def _toml(value: Any) -> str:
    if isinstance(value, list):
        return f"[{', '.join(_toml(item) for item in value)}]"
    return str(value) if isinstance(value, int) else quoted(str(value))
