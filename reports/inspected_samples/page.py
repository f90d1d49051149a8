"""What ``tethertest inspect`` says of every file of a folder, as one table."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from pathlib import Path
from typing import Any, Final

from tethertest.jobs.inspect import inspected
from tethertest.jobs.remarks import grouped, some
from tethertest.render.as_json import as_json

#: what stands below this line of the page is written by hand, and kept
BY_HAND: Final = "<!-- written by hand from here on -->"
#: a mean rate that differs by more than this share is told
OTHER_RATE: Final = 0.02
#: signs that would end a cell of a table, or be taken for markup
_ESCAPED: Final = str.maketrans({"|": "\\|", "\n": " ", "<": "&lt;", "`": "'", "*": "\\*", "_": "\\_"})
#: flags that values show by themselves, and that are worth telling where there are none
_LOOKED_FOR: Final = ("stuck", "saturated", "spike")
_HEADINGS: Final = (
    "file",
    "format",
    "rows",
    "channels",
    "rate",
    "span",
    "units",
    "flags, remarks or refusal",
)


def rows_of(folder: Path, settings: Sequence[tuple[str, str]] = ()) -> list[tuple[str, ...]]:
    """Inspect every file of a folder and what lies below it.

    Parameters
    ----------
    folder : Path
        Hidden files and folders are left out.
    settings : sequence of tuple
        File relative to the folder, and a setting ``KEY=VALUE``: such a file has a second row, read with it.

    Returns
    -------
    list of tuple
        One row of the table per file, as plain text.
    """
    rows = []
    for path in sorted(path for path in folder.rglob("*") if path.is_file()):
        name = path.relative_to(folder).as_posix()
        if any(part.startswith(".") for part in Path(name).parts):
            continue
        words = [word for file, word in settings if file == name]
        rows.append(_row(name, as_json(inspected(path)), folder))
        if words:
            given = " ".join(f"--set {word}" for word in words)
            rows.append(_row(f"{name} {given}", as_json(inspected(path, words=words)), folder))
    return rows


def page(folder: Path, settings: Sequence[tuple[str, str]] = (), by_hand: str = "") -> str:
    """Return the page in Markdown.

    Parameters
    ----------
    folder, settings
        As for `rows_of`.
    by_hand : str
        What stands below the table.
    """
    rows = rows_of(folder, settings)
    refused = sum(1 for row in rows if row[2] == "")
    lines = [
        "# What inspect says of sample logs",
        "",
        "Written by `python -m reports.inspected_samples FOLDER`. "
        f"{len(rows)} readings, {refused} of them refused. Rate is that of the usual step between stamps; "
        "units are as written and, behind the arrow, as used. Flags count samples.",
        "",
        f"| {' | '.join(_HEADINGS)} |",
        f"|{'---|' * len(_HEADINGS)}",
        *(f"| {' | '.join(cell.translate(_ESCAPED) for cell in row)} |" for row in rows),
    ]
    return "\n".join(lines) + "\n" + (f"\n{BY_HAND}\n{by_hand}" if by_hand else "")


def _row(name: str, found: dict[str, Any], folder: Path) -> tuple[str, ...]:
    if found["refused"]:
        line = "" if found["line"] is None else f"line {found['line']}: "
        said = f"refused: {line}{found['message']}. Fix: {found['remedy']}"
        return (name, found["format"] or "none", "", "", "", "", "", said.replace(f"{folder}/", ""))
    channels = found["channels"]
    sizes = sorted({channel["n"] for channel in channels})
    spans = sorted({channel["duration"] for channel in channels})
    rates = sorted({channel["rate"] for channel in channels if channel["rate"] is not None})
    encoding = found["encoding"]
    return (
        name,
        f"{found['format']}, {encoding}" if encoding else found["format"],
        _range(sizes, "d"),
        str(len(channels)),
        _rate(rates, found.get("time_bases", [])),
        f"{_range(spans, '.6g')} s",
        _units(channels),
        "; ".join(_said(found)),
    )


def _rate(rates: Sequence[float], bases: Sequence[dict[str, Any]]) -> str:
    """Return the rates, and the mean rates where they are others."""
    if not rates:
        return "none"
    means = sorted({base["mean_rate"] for base in bases if base.get("mean_rate")})
    said = f"{_range(rates, '.6g')} Hz"
    off = [mean for mean in means if min(abs(mean / rate - 1.0) for rate in rates) > OTHER_RATE]
    return f"{said}, mean {_range(off, '.4g')} Hz" if off else said


def _range(numbers: Sequence[float], form: str) -> str:
    ends = [format(number, form) for number in (numbers[0], numbers[-1])] if numbers else []
    return " to ".join(dict.fromkeys(ends))


def _units(channels: Sequence[dict[str, Any]]) -> str:
    """Return the units as written and as used, with the number of channels where that is not all."""
    counts = Counter((channel["unit_as_written"], channel["unit"]) for channel in channels)
    said = []
    for (written, used), count in counts.items():
        unit = "none" if not written else written if written == used else f"{written} → {used}"
        said.append(unit if len(counts) == 1 else f"{unit} ({count})")
    return ", ".join(said)


def _said(found: dict[str, Any]) -> list[str]:
    """Return what the stamps are like, the flags of channels, and the remarks."""
    bases = found.get("time_bases", [])
    of_time = {name for base in bases for name in base["flags"]}
    said = [f"time: {base['text']}" for base in bases]
    flagged: dict[str, list[tuple[str, int]]] = {}
    for channel in found["channels"]:
        for flag, count in channel["flags"].items():
            if count and flag not in of_time:
                flagged.setdefault(flag, []).append((channel["name"], count))
    for flag, hits in flagged.items():
        counts = sorted(count for _, count in hits)
        said.append(f"{flag} {_range(counts, 'd')} in {some([name for name, _ in hits])}")
    clean = [flag for flag in _LOOKED_FOR if _is_clean(found["channels"], flag)]
    if clean:
        said.append(f"looked for and not found: {', '.join(clean)}")
    return said + grouped(found["remarks"])


def _is_clean(channels: Sequence[dict[str, Any]], flag: str) -> bool:
    """Return whether a flag was looked for in some channel and found in none."""
    counts = [channel["flags"][flag] for channel in channels if flag in channel["flags"]]
    return bool(counts) and not any(counts)
