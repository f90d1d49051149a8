"""The encoding of a text log, found by its content."""

from __future__ import annotations

import codecs
import re
from collections import Counter
from collections.abc import Iterator
from typing import Final

_BYTE_ORDER_MARKS: Final = (
    (codecs.BOM_UTF8, "utf-8-sig"),
    (codecs.BOM_UTF16_LE, "utf-16"),
    (codecs.BOM_UTF16_BE, "utf-16"),
)
_HIGH_BYTES = re.compile(rb"[\x80-\xff]+")
_CONTROL = re.compile(rb"[\x01-\x08\x0e-\x1a\x1c-\x1f]")
#: enough to tell text from binary
_SAMPLE_BYTES: Final = 65536
#: GB 2312 rows of symbols and of the common ideographs, as lead bytes
SYMBOLS = range(0xA1, 0xAA)
COMMON_IDEOGRAPHS = range(0xB0, 0xD8)
#: Shift JIS rows of symbols, kana and the common ideographs, as lead bytes; Western text seldom has them
_JAPANESE_LEADS: Final = range(0x81, 0x98)
_FEWEST_JAPANESE: Final = 2


def detect_encoding(data: bytes, *, complete: bool = True) -> str | None:
    """Return the encoding of a text, or None where the bytes are no text.

    Parameters
    ----------
    data : bytes
        The text, or its beginning.
    complete : bool
        False where `data` may stop in the middle of a character.

    Returns
    -------
    str or None
        ``ascii``, ``utf-8``, ``utf-8-sig``, ``utf-16``, ``utf-16-le``, ``utf-16-be``, ``gb18030``,
        ``cp932`` (Shift JIS), ``cp1252``.
    """
    for mark, encoding in _BYTE_ORDER_MARKS:
        if data.startswith(mark):
            return encoding
    if b"\0" in data:
        return _utf16_without_mark(data)
    if data.isascii():
        return "ascii" if _is_text(data) else None
    if _decodes(data, "utf-8", complete=complete):
        return "utf-8" if _is_text(data) else None
    if not _is_text(data):
        return None
    if _decodes(data, "cp932", complete=complete):
        text = codecs.getincrementaldecoder("cp932")("strict").decode(data, complete)
        if is_japanese(Counter(japanese_characters(text))):
            return "cp932"
    return "gb18030" if _is_chinese(data, complete=complete) else "cp1252"


def decodes(data: bytes, encoding: str) -> bool:
    """Return whether the complete text is valid in that encoding."""
    return _decodes(data, encoding, complete=True)


def _decodes(data: bytes, encoding: str, *, complete: bool) -> bool:
    try:
        codecs.getincrementaldecoder(encoding)("strict").decode(data, complete)
    except (UnicodeDecodeError, UnicodeError):
        return False
    return True


def _is_text(data: bytes) -> bool:
    data = data[:_SAMPLE_BYTES]
    return len(_CONTROL.findall(data)) <= len(data) // 1000


def _utf16_without_mark(data: bytes) -> str | None:
    """Tell UTF-16 from binary: text of logs is mostly ASCII, so every second byte is zero."""
    pairs = len(data) // 2
    sample = data[: 2 * pairs]
    for encoding, zeros, others in (
        ("utf-16-le", sample[1::2], sample[0::2]),
        ("utf-16-be", sample[0::2], sample[1::2]),
    ):
        if zeros.count(0) > 0.7 * pairs and not others.count(0) and _is_text(others):
            return encoding
    return None


def _is_chinese(data: bytes, *, complete: bool) -> bool:
    """Tell GB 18030 from Western text.

    In Western text a byte above 127 stands alone (``°C``, ``µm``); in Chinese text such bytes come in pairs,
    nearly all of them symbols or common ideographs.
    """
    runs = [match.group() for match in _HIGH_BYTES.finditer(data)]
    if not complete and data[-1] >= 0x80 and runs:
        runs = runs[:-1]
    if not runs or any(len(run) % 2 for run in runs) or not _decodes(data, "gb18030", complete=complete):
        return False
    leads = [lead for run in runs for lead in run[::2]]
    common = sum(lead in SYMBOLS or lead in COMMON_IDEOGRAPHS for lead in leads)
    return common >= 0.8 * len(leads)


def japanese_characters(text: str) -> Iterator[bool]:
    """Yield for each character beyond ASCII whether it is a common one of Shift JIS."""
    for character in text:
        if not character.isascii():
            yield character.encode("cp932")[0] in _JAPANESE_LEADS


def is_japanese(characters: Counter[bool]) -> bool:
    """Tell Shift JIS from Western and Chinese text: nearly all of its wide characters are common ones."""
    return characters[True] >= max(_FEWEST_JAPANESE, 0.8 * characters.total())
