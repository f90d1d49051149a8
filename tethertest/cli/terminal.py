"""What a terminal is given: tables, and texts of files without their control characters."""

from __future__ import annotations

import re
from typing import Any, Final

#: columns of a page that is no terminal
_WIDTH: Final = 160
#: a name in a log may hold the codes that move a terminal's cursor or colour what follows
_CONTROL: Final = re.compile(r"[\x00-\x08\x0b-\x1f\x7f-\x9f\u202a-\u202e\u2066-\u2069]")


def table_console() -> Any:
    """Return a rich console that prints texts as they are: brackets are part of names and units."""
    from rich.console import Console

    return Console(highlight=False, markup=False, width=None if Console().is_terminal else _WIDTH)


def printable(found: Any) -> Any:
    r"""Return texts, and those in lists and dictionaries, with control characters as ``\x1b``.

    Parameters
    ----------
    found : str, list, dict or other
        Other values are returned as they are.
    """
    if isinstance(found, str):
        return _CONTROL.sub(lambda match: ascii(match[0])[1:-1], found)
    if isinstance(found, dict):
        return {printable(key): printable(value) for key, value in found.items()}
    if isinstance(found, list | tuple):
        return [printable(value) for value in found]
    return found
