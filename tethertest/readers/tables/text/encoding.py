"""The encoding of a text log, found by its content, in bounded memory where it is long."""

from __future__ import annotations

import codecs
import re
from collections import Counter
from collections.abc import Iterable, Iterator
from typing import Final

_BYTE_ORDER_MARKS: Final = (
    (codecs.BOM_UTF8, "utf-8-sig"),
    (codecs.BOM_UTF16_LE, "utf-16"),
    (codecs.BOM_UTF16_BE, "utf-16"),
)
_HIGH: Final = bytes(range(0x80, 0x100))
_HIGH_BYTES = re.compile(rb"[\x80-\xff]+")
_CONTROL = re.compile(rb"[\x01-\x08\x0e-\x1a\x1c-\x1f]")
#: enough to tell text from binary
_SAMPLE_BYTES: Final = 65536
#: a text in memory is looked at in pieces of this size: most of them are plain ASCII and need no decoder
_PIECE_BYTES: Final = 65536
#: GB 2312 rows of symbols and of the common ideographs, as lead bytes
_CHINESE_LEADS: Final = frozenset([*range(0xA1, 0xAA), *range(0xB0, 0xD8)])
_SHIFT_JIS: Final = "cp932"
#: Shift JIS rows of symbols, kana and the common ideographs, as lead bytes; Western text seldom has them
_JAPANESE_LEADS: Final = range(0x81, 0x98)
_FEWEST_JAPANESE: Final = 2
#: a text is of a language where so much of what is not ASCII is common in it
_MOSTLY: Final = 0.8


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
    if not _is_text(data):
        return None
    pieces = (data[begin : begin + _PIECE_BYTES] for begin in range(0, len(data), _PIECE_BYTES))
    return encoding_of_blocks(pieces, complete=complete)


def encoding_of_blocks(blocks: Iterable[bytes], *, complete: bool = True) -> str:
    """Return the encoding of a text of single bytes and characters of several.

    In Western text a byte above 127 stands alone (``°C``, ``µm``); in Chinese text such bytes come in pairs,
    nearly all of them symbols or common ideographs; in Japanese text nearly all wide characters are common
    ones of Shift JIS.

    Parameters
    ----------
    blocks : iterable of bytes
        The text from its start, cut anywhere.
    complete : bool
        False where it may stop in the middle of a character.

    Returns
    -------
    str
        ``ascii``, ``utf-8``, ``cp932``, ``gb18030`` or ``cp1252``.
    """
    signs = _Signs()
    carry = b""
    for block in blocks:
        data = carry + block
        kept = len(data.rstrip(_HIGH))  # a run of high bytes may go on in the next block
        data, carry = data[:kept], data[kept:]
        if not data.isascii():
            signs.count(data)
            signs.decode(data)
    if complete and carry:
        signs.count(carry)
    signs.decode(carry, final=complete)
    return signs.encoding(is_ascii=not signs.runs and not carry)


class _Signs:
    """What the bytes of a text say of its encoding."""

    def __init__(self) -> None:
        self.runs = 0  # of bytes above 127
        self._odd_runs = 0
        self._leads: Counter[bool] = Counter()  # every second byte of a run: of common Chinese, or not
        self._wide: Counter[bool] = Counter()  # characters beyond ASCII in Shift JIS: common ones, or not
        names = ("utf-8", "gb18030", _SHIFT_JIS)
        self._decoders = {name: codecs.getincrementaldecoder(name)() for name in names}  # that still can

    def count(self, data: bytes) -> None:
        """Count the bytes above 127, which begin and end in these."""
        runs = _HIGH_BYTES.findall(data)
        self.runs += len(runs)
        self._odd_runs += sum(len(run) % 2 for run in runs)
        self._leads.update(lead in _CHINESE_LEADS for run in runs for lead in run[::2])

    def decode(self, data: bytes, *, final: bool = False) -> None:
        """Try what comes next in every encoding that is still possible."""
        for name, decoder in list(self._decoders.items()):
            try:
                text = decoder.decode(data, final)
            except UnicodeDecodeError:
                del self._decoders[name]
                continue
            if name == _SHIFT_JIS:
                self._wide.update(_japanese_characters(text))

    def encoding(self, *, is_ascii: bool) -> str:
        """Return what they amount to."""
        if is_ascii:
            return "ascii"
        if "utf-8" in self._decoders:
            return "utf-8"
        if _SHIFT_JIS in self._decoders and self._wide[True] >= max(
            _FEWEST_JAPANESE, _MOSTLY * self._wide.total()
        ):
            return _SHIFT_JIS
        is_paired = self.runs and not self._odd_runs and "gb18030" in self._decoders
        return "gb18030" if is_paired and self._leads[True] >= _MOSTLY * self._leads.total() else "cp1252"


def _japanese_characters(text: str) -> Iterator[bool]:
    """Yield for each character beyond ASCII whether it is a common one of Shift JIS."""
    for character in text:
        if not character.isascii():
            yield character.encode(_SHIFT_JIS)[0] in _JAPANESE_LEADS


def decodes(data: bytes, encoding: str) -> bool:
    """Return whether the complete text is valid in that encoding."""
    try:
        codecs.getincrementaldecoder(encoding)("strict").decode(data, final=True)
    except UnicodeError:
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
