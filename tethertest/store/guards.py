"""What a store may hold: every object is looked at before it is read, so that no file can do harm.

A link out of the file, a dataset whose samples lie elsewhere, a filter that loads a library, a shape without
data behind it: each is refused with the path of the object.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from tethertest.errors import FileFormatError
from tethertest.store.names import plain

#: filters of HDF5 itself (deflate, shuffle, fletcher32); others are libraries that a file could name
_FILTERS = (1, 2, 3)
#: bytes of a chunk in memory; ours have 256 KiB
_LARGEST_CHUNK = 1 << 26
#: samples of one series; a day at 10 kHz is less
LARGEST_SERIES = 1 << 31
#: entries of a list of texts in an attribute, and members of a group
_LARGEST_LIST = 100_000

_AGAIN = "ingest the run again from its raw logs"


def refused(path: Path, place: str, problem: str, remedy: str = _AGAIN) -> FileFormatError:
    """Return the error about one object of a store."""
    return FileFormatError(f"{place}: {problem}", remedy, path=path)


def child(path: Path, group: Any, name: str, kind: str) -> Any:
    """Return a member of a group that is held in the same file, opened.

    Parameters
    ----------
    path : Path
        The store, for messages.
    group : h5py.Group
        The parent.
    name : str
        Of the member.
    kind : str
        ``"group"`` or ``"dataset"``.

    Raises
    ------
    FileFormatError
        It is missing, is a link to elsewhere, is damaged, or is not of that kind.
    """
    import h5py

    place = f"{group.name.rstrip('/')}/{name}"
    try:
        link = group.get(name, getlink=True)
    except KeyError:
        link = None
    if link is None:
        raise refused(path, place, f"missing, expected a {kind}")
    if not isinstance(link, h5py.HardLink):
        words = "an external link" if isinstance(link, h5py.ExternalLink) else "a soft link"
        raise refused(path, place, f"found {words}, expected a {kind} of this file")
    try:
        item = group[name]
    except (KeyError, OSError, RuntimeError, ValueError) as error:
        raise refused(path, place, "damaged, it cannot be opened") from error
    if not isinstance(item, {"group": h5py.Group, "dataset": h5py.Dataset}[kind]):
        raise refused(path, place, f"found a {type(item).__name__.lower()}, expected a {kind}")
    return item


def members(path: Path, group: Any) -> list[str]:
    """Return the names in a group.

    Raises
    ------
    FileFormatError
        It has more than any run has, or it is damaged.
    """
    try:
        if len(group) > _LARGEST_LIST:
            raise refused(path, group.name, f"found {len(group)} members, expected a few")
        return [str(name) for name in group]
    except (OSError, RuntimeError, ValueError) as error:
        raise refused(path, group.name, "damaged, its members cannot be listed") from error


def checked_series(path: Path, data: Any, dtype: str, columns: int | None = None) -> int:
    """Check a dataset before a sample of it is read, and return its length.

    Parameters
    ----------
    path : Path
        The store, for messages.
    data : h5py.Dataset
        The dataset.
    dtype : str
        Type that it must have, whatever its byte order.
    columns : int, optional
        Of a table; without it the dataset must have one dimension.

    Raises
    ------
    FileFormatError
        Type, shape, storage or filters are not those of a store.
    """
    import h5py

    wanted = np.dtype(dtype)
    found = data.dtype
    if (found.kind, found.itemsize) != (wanted.kind, wanted.itemsize):
        raise refused(path, data.name, f"found type {found}, expected {wanted.name}")
    shape = data.shape
    if shape is None or len(shape) != (1 if columns is None else 2) or (columns and shape[1] != columns):
        form = "(n,)" if columns is None else f"(n, {columns})"
        raise refused(path, data.name, f"found shape {shape}, expected {form}")
    length = int(shape[0])
    if length > LARGEST_SERIES:
        raise refused(path, data.name, f"found {length} samples, more than any run has")
    settings = data.id.get_create_plist()
    if settings.get_layout() == h5py.h5d.VIRTUAL or settings.get_external_count():
        raise refused(path, data.name, "its samples lie in another file")
    for number in range(settings.get_nfilters()):
        code = settings.get_filter(number)[0]
        if code not in _FILTERS:
            raise refused(path, data.name, f"found filter {code}, expected gzip, shuffle or fletcher32")
    _check_storage(path, data, length * wanted.itemsize * (columns or 1))
    return length


def _check_storage(path: Path, data: Any, size: int) -> None:
    """Refuse a shape that has no data behind it: HDF5 would fill it without end."""
    if data.chunks is None:
        if size and data.id.get_storage_size() < size:
            raise refused(path, data.name, f"declared with shape {data.shape}, but not all of it was written")
        return
    if math.prod(data.chunks) * data.dtype.itemsize > _LARGEST_CHUNK:
        raise refused(path, data.name, f"found chunks of {data.chunks}, expected small ones")
    expected = math.prod(-(-extent // chunk) for extent, chunk in zip(data.shape, data.chunks, strict=True))
    if expected > _LARGEST_LIST * 10 or data.id.get_num_chunks() < expected:
        raise refused(path, data.name, f"declared with shape {data.shape}, but not all of it was written")


def read_block(path: Path, data: Any, start: int, stop: int) -> npt.NDArray[Any]:
    """Return samples of a dataset that was checked, in the machine's own byte order.

    Raises
    ------
    FileFormatError
        They are damaged.
    """
    try:
        block = data[start:stop]
    except (OSError, RuntimeError, ValueError) as error:
        raise refused(path, data.name, f"damaged, samples {start} to {stop} cannot be read") from error
    return np.asarray(block, dtype=data.dtype.newbyteorder("="))


def read_texts(path: Path, data: Any) -> tuple[str, ...]:
    """Return a column of texts.

    Raises
    ------
    FileFormatError
        It is no column of texts, or it is damaged.
    """
    import h5py

    if h5py.check_string_dtype(data.dtype) is None or data.shape is None or len(data.shape) != 1:
        raise refused(path, data.name, f"found type {data.dtype} of shape {data.shape}, expected texts (n,)")
    if data.id.get_create_plist().get_external_count() or data.shape[0] > _LARGEST_LIST:
        raise refused(path, data.name, f"found {data.shape[0]} texts, more than any run has")
    return tuple(_decoded(path, data.name, item) for item in read_block_of_texts(path, data))


def read_block_of_texts(path: Path, data: Any) -> Sequence[object]:
    """Return the entries of a column of texts as they are.

    Raises
    ------
    FileFormatError
        They are damaged.
    """
    try:
        return list(data[()])
    except (OSError, RuntimeError, ValueError) as error:
        raise refused(path, data.name, "damaged, its texts cannot be read") from error


def text(path: Path, item: Any, key: str, default: str | None = None) -> str:
    """Return an attribute that is text.

    Raises
    ------
    FileFormatError
        It is missing and there is no default, or it is no text.
    """
    value = _attribute(path, item, key)
    if value is None and default is not None:
        return default
    return _decoded(path, f"{item.name}@{key}", value)


def optional_text(path: Path, item: Any, key: str) -> str | None:
    """Return an attribute that is text, None where there is none."""
    return text(path, item, key) if key in item.attrs else None


def texts(path: Path, item: Any, key: str) -> tuple[str, ...]:
    """Return an attribute that is a list of texts.

    Raises
    ------
    FileFormatError
        It is missing or no list of texts.
    """
    value = _attribute(path, item, key)
    if not isinstance(value, np.ndarray) or value.ndim != 1:
        raise refused(path, f"{item.name}@{key}", f"found {_shown(value)}, expected a list of texts")
    return tuple(_decoded(path, f"{item.name}@{key}", entry) for entry in value)


def number(path: Path, item: Any, key: str) -> float:
    """Return an attribute that is a finite number.

    Raises
    ------
    FileFormatError
        It is missing or no finite number.
    """
    value = _attribute(path, item, key)
    if isinstance(value, np.integer | np.floating) and math.isfinite(value):
        return float(value)
    raise refused(path, f"{item.name}@{key}", f"found {_shown(value)}, expected a number")


def _attribute(path: Path, item: Any, key: str) -> Any:
    place = f"{item.name}@{key}"
    try:
        if key not in item.attrs:
            return None
        shape = item.attrs.get_id(key).shape
        if shape is None or math.prod(shape) > _LARGEST_LIST:
            raise refused(path, place, f"found shape {shape}, expected a single value or a short list")
        return item.attrs[key]
    except (KeyError, OSError, RuntimeError, ValueError, TypeError) as error:
        raise refused(path, place, "damaged, it cannot be read") from error


def _decoded(path: Path, place: str, value: object) -> str:
    if isinstance(value, bytes):
        value = value.decode("utf-8", "replace")
    if not isinstance(value, str):
        raise refused(path, place, f"found {_shown(value)}, expected text")
    return plain(value)


def _shown(value: object) -> str:
    return "nothing" if value is None else repr(value)[:60]
