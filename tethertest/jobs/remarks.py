"""Remarks on a log for a person: what is said of many columns alike is said once."""

from __future__ import annotations

import re
from collections.abc import Sequence
from typing import Final

#: names in one line; the others are counted
NAMED: Final = 3
#: a remark about one column: what it is, its name in quotes, the rest
_ABOUT: Final = re.compile(r"(column|channel) ('[^']*'|\"[^\"]*\")(: .*)")


def grouped(remarks: Sequence[str]) -> list[str]:
    """Return the remarks, those that say the same of several columns as one, in their order.

    Parameters
    ----------
    remarks : sequence of str
        As a reader and ``inspect`` make them.
    """
    groups: dict[tuple[str, str], list[str]] = {}
    for remark in remarks:
        match = _ABOUT.fullmatch(remark)
        key = (match[1], match[3]) if match else ("", remark)
        groups.setdefault(key, []).append(match[2] if match else "")
    said = []
    for (what, text), names in groups.items():
        if not what:
            said.append(text)
        elif len(names) == 1:
            said.append(f"{what} {names[0]}{text}")
        else:
            said.append(f"{len(names)} {what}s{text} ({some(names)})")
    return said


def some(names: Sequence[str]) -> str:
    """Return the first names, and how many more there are."""
    more = f" and {len(names) - NAMED} more" if len(names) > NAMED else ""
    return ", ".join(names[:NAMED]) + more
