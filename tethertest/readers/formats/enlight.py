"""What the exports of ENLIGHT (HYPERION interrogators) share: a block of keys, then one row of names."""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import Final

from tethertest.readers.tables.text.document import Head
from tethertest.records.run import Log

#: lines that only ENLIGHT writes above its data
_KEYS = re.compile(
    r"(?:ENLIGHT Version|Module Type|Timestamp Format|Culture|Firmware Version)\s*:", re.IGNORECASE
)
#: cultures whose numbers have a decimal point; the others on the instrument's list write a comma
_POINT_CULTURES: Final = ("en", "zh", "ja", "ko", "th", "he")


@dataclass(frozen=True, slots=True)
class Preamble:
    """Where the row of names is, and what the keys above it say about signs."""

    names_line: int  #: from 1
    names: tuple[str, ...]
    culture: str  #: such as "pt-PT", "" where it is not written
    keys_found: bool

    def decimal(self, first_row: str, settings: Log) -> str:
        """Return the decimal sign; the columns are separated by tabs, so a comma in a row is one."""
        if settings.decimal is not None:
            return settings.decimal
        if self.culture:
            return "." if self.culture.lower().startswith(_POINT_CULTURES) else ","
        return "," if "," in first_row.partition("\t")[2] else "."

    def date_order(self, settings: Log) -> str | None:
        """Return the order of dates that do not begin with the year, None where the file leaves it open."""
        if settings.date_order is not None:
            return settings.date_order
        if not self.culture:
            return None
        return "mdy" if self.culture == "en-US" else "dmy"


def find_preamble(lines: tuple[str, ...] | list[str]) -> Preamble | None:
    """Return the preamble if a row of names begins with ``Timestamp`` and a tab."""
    culture, keys_found = "", False
    for number, line in enumerate(lines, start=1):
        if line.startswith("Timestamp\t"):
            names = tuple(cell.strip() for cell in line.rstrip("\t").split("\t"))
            return Preamble(number, names, culture, keys_found)
        if _KEYS.match(line):
            keys_found = True
            key, _, value = line.partition(":")
            if key.strip().lower() == "culture" and re.fullmatch(r"[a-z]{2}-[A-Z]{2}", value.strip()):
                culture = value.strip()
    return None


def has_mark(head: Head) -> bool:
    """Return whether the file begins with a UTF-8 byte-order mark, as ENLIGHT writes it."""
    return head.data.startswith(b"\xef\xbb\xbf")
