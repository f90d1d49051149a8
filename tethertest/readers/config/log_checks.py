"""What must hold within the settings of one log, whatever run and rig it belongs to."""

from __future__ import annotations

import codecs
import re
from collections.abc import Iterator
from zoneinfo import ZoneInfo

from tethertest.errors import QuantityError
from tethertest.readers.config.mapping_checks import mapping_problems
from tethertest.readers.config.problems import Problem
from tethertest.readers.config.toml import KeyPath
from tethertest.readers.tables.text.layout import SPELLINGS
from tethertest.readers.tables.time_units import is_time_unit
from tethertest.records.run import Log
from tethertest.units import channel_scale

#: rows above the names of the columns; the longest header known has 104
MOST_SKIPPED = 100_000
#: codecs that spell text in other text: no logger writes them, and some warn or fail on plain text
_SPELLED = {"idna", "punycode", "raw-unicode-escape", "unicode-escape"}
#: signs that numbers, names and quoted cells have inside
_IN_CELLS = "\"'.+-_#"
_NAMED_SEPARATORS = ", ".join(sorted(name for name in SPELLINGS if name.isalpha()))
_UTC_OFFSET = re.compile(r"[+-](0\d|1[0-4]):?[0-5]\d")


def setting_problems(key: KeyPath, log: Log) -> Iterator[Problem]:
    """Yield what is wrong in the settings of a log, before the file is opened.

    Parameters
    ----------
    key : tuple
        Where the log's entry stands in its file; empty where it is the whole.
    log : Log
        Its `file`, `clock` and `channels` are not looked at: these need the run and its rig.
    """
    if not 0 <= log.skip_rows <= MOST_SKIPPED:
        text = f"found {log.skip_rows}, expected 0 or more rows, and at most {MOST_SKIPPED}"
        yield Problem((*key, "skip_rows"), text, "count the rows to leave out from the top")
    if log.encoding is not None and not _is_encoding(log.encoding):
        text = f"found {log.encoding!r}, which is no known encoding"
        yield Problem((*key, "encoding"), text, "use one such as utf-8, cp1252, gbk or utf-16")
    if log.time_zone is not None and not _is_zone(log.time_zone):
        text = f"found {log.time_zone!r}, expected a time zone"
        yield Problem((*key, "time_zone"), text, 'write "Asia/Shanghai" or "+08:00"')
    if log.separator is not None and not _is_separator(log.separator):
        text = f"found {log.separator!r}, expected the one sign that stands between two columns"
        yield Problem((*key, "separator"), text, f"use one such as ; or |, or one of {_NAMED_SEPARATORS}")
    elif log.separator is not None and SPELLINGS.get(log.separator, log.separator) == log.decimal:
        text = f"found {log.separator!r}, which is the decimal sign too"
        yield Problem((*key, "separator"), text, "correct separator or decimal")
    for name, unit in log.units.items():
        try:
            if not is_time_unit(unit):
                channel_scale(unit)
        except QuantityError as error:
            yield Problem((*key, "units", name), error.problem, error.remedy)
    yield from mapping_problems(key, log)


def _is_encoding(name: str) -> bool:
    """Return whether bytes become text by this name: some codecs turn text into text, or bytes into bytes."""
    try:
        if codecs.lookup(name).name.replace("_", "-") in _SPELLED:
            return False
        bytes(4).decode(name)  # as many bytes as the widest character has; none at all never fails
    except (LookupError, ValueError):  # a NUL in the name is a ValueError
        return False
    return True


def _is_separator(text: str) -> bool:
    if text in SPELLINGS or text in SPELLINGS.values():
        return True
    return len(text) == 1 and text.isprintable() and not text.isalnum() and text not in _IN_CELLS


def _is_zone(name: str) -> bool:
    if _UTC_OFFSET.fullmatch(name):
        return True
    try:
        ZoneInfo(name)
    except (OSError, ValueError, KeyError):  # an unknown zone is a KeyError
        return False
    return True
