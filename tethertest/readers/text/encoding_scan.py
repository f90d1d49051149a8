"""The encoding of a log whose beginning is plain ASCII: what its later bytes say, in bounded memory."""

from __future__ import annotations

import codecs
import re
from collections import Counter
from collections.abc import Iterable

from tethertest.readers.text.encoding import (
    COMMON_IDEOGRAPHS,
    SYMBOLS,
    is_japanese,
    japanese_characters,
)

_SHIFT_JIS = "cp932"
_HIGH_BYTES = re.compile(rb"[\x80-\xff]+")


def encoding_of_blocks(blocks: Iterable[bytes]) -> str:
    """Return the encoding of a whole text, by the rules of `detect_encoding`.

    Parameters
    ----------
    blocks : iterable of bytes
        The text from its start, cut anywhere; its beginning is ASCII.

    Returns
    -------
    str
        ``ascii``, ``utf-8``, ``cp932``, ``gb18030`` or ``cp1252``.
    """
    decoders = {name: codecs.getincrementaldecoder(name)() for name in ("utf-8", "gb18030", _SHIFT_JIS)}
    leads = common = 0
    wide: Counter[bool] = Counter()  # characters beyond ASCII as Shift JIS has them: common ones, and others
    paired, carry, found = True, b"", False
    for block in blocks:
        data = carry + block
        kept = len(data.rstrip(bytes(range(0x80, 0x100))))  # a run may go on in the next block
        data, carry = data[:kept], data[kept:]
        if data.isascii():
            continue
        found = True
        runs = _HIGH_BYTES.findall(data)
        paired &= all(len(run) % 2 == 0 for run in runs)
        leads += sum(len(run) // 2 for run in runs)
        common += sum(lead in SYMBOLS or lead in COMMON_IDEOGRAPHS for run in runs for lead in run[::2])
        texts = {name: _taken(decoder, data) for name, decoder in decoders.items()}
        wide.update(japanese_characters(texts.get(_SHIFT_JIS) or ""))
        decoders = {name: decoder for name, decoder in decoders.items() if texts[name] is not None}
    if carry:
        found = True
        paired &= len(carry) % 2 == 0
        leads += len(carry) // 2
        common += sum(lead in SYMBOLS or lead in COMMON_IDEOGRAPHS for lead in carry[::2])
    texts = {name: _taken(decoder, carry, final=True) for name, decoder in decoders.items()}
    wide.update(japanese_characters(texts.get(_SHIFT_JIS) or ""))
    decoders = {name: decoder for name, decoder in decoders.items() if texts[name] is not None}
    if not found:
        return "ascii"
    if "utf-8" in decoders:
        return "utf-8"
    if _SHIFT_JIS in decoders and is_japanese(wide):
        return _SHIFT_JIS
    return "gb18030" if paired and leads and "gb18030" in decoders and common >= 0.8 * leads else "cp1252"


def _taken(decoder: codecs.IncrementalDecoder, data: bytes, *, final: bool = False) -> str | None:
    """Return the text, or None where the bytes are none of that encoding."""
    try:
        return decoder.decode(data, final)
    except UnicodeDecodeError:
        return None
