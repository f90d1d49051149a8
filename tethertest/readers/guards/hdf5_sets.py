"""A data set of HDF5, by its own header, before anything of it is read: place, size, filters, chunks."""

from __future__ import annotations

from math import prod
from typing import Any, Final

import numpy as np

from tethertest.readers.guards.limits import CELLS, COMPRESSION_RATIO, RATIO_FROM

#: deflate, shuffle, fletcher32, szip, nbit, scaleoffset; lzf comes with h5py
_FILTERS: Final = {
    1: "deflate",
    2: "shuffle",
    3: "fletcher32",
    4: "szip",
    5: "nbit",
    6: "scaleoffset",
    32000: "lzf",
}


def trouble_of(item: Any, shape: tuple[int, ...]) -> str:
    """Return why a data set is not read, before anything of it is."""
    if item.is_virtual or item.external is not None:
        return "keeps its values in another file"
    if prod(shape) > CELLS:
        return f"declares {'x'.join(map(str, shape))} values, expected at most {CELLS}"
    if item.dtype.kind == "V" and prod(shape) * max(item.dtype.itemsize // 8, 1) > CELLS:
        return f"declares {shape[0]} records of {item.dtype.itemsize} bytes, expected at most {CELLS} numbers"
    if prod(shape) * item.dtype.itemsize > max(RATIO_FROM, COMPRESSION_RATIO * item.file.id.get_filesize()):
        return "unpacks to more than a log of the file's size holds"
    properties = item.id.get_create_plist()
    for number in range(properties.get_nfilters()):
        code, _, _, label = properties.get_filter(number)
        if code not in _FILTERS:
            name = label.decode(errors="replace")[:40] or code
            return f"is compressed by a filter that is not known here ({name}): export it with gzip"
    if prod(shape) and item.id.get_storage_size() == 0:
        return "declares values but holds none"
    if item.chunks is not None:
        if prod(item.chunks) * item.dtype.itemsize > CELLS * 8:
            return "has chunks larger than a log"
        wanted = prod(-(-side // chunk) for side, chunk in zip(shape, item.chunks, strict=True))
        written = item.id.get_num_chunks()
        if written < wanted and not (item.dtype.kind == "f" and np.isnan(item.fillvalue)):
            return f"was written in part only: {written} of {wanted} chunks"
    return ""
