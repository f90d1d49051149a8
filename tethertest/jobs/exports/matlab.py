"""MATLAB, version 5: a struct per channel, and one of the run."""

from __future__ import annotations

import keyword
import re
from collections.abc import Iterable
from typing import Any, cast

import numpy as np

from tethertest import __version__
from tethertest.errors import TethertestError
from tethertest.jobs.exports.source import Exported, Series
from tethertest.records.channel import Flag
from tethertest.store.layout import SOURCE_TEXTS
from tethertest.store.whole import WholeFile

#: longest name in MATLAB
_LONGEST = 63
#: bytes of a variable that the format can hold, with some left for its fields
_LARGEST = 2**31 - 2**20
#: text at the head of a file of the format; after it come fields that stay
_HEAD = 116
#: words that are no names in MATLAB, and Python's, which does no harm
_KEYWORDS = frozenset(keyword.kwlist) | frozenset(("case", "catch", "end", "function", "otherwise", "switch"))


def write_mat(file: WholeFile, run: Exported) -> None:
    """Write all channels as one MATLAB file.

    Parameters
    ----------
    file : WholeFile
        An open file.
    run : Exported
        Its channels become structs named like them, as far as MATLAB allows; the field ``name`` has the name
        itself, ``flag`` holds the bits that ``run.flags`` names.

    Raises
    ------
    TethertestError
        A channel is larger than the format can hold.
    """
    from scipy.io import savemat

    for series in run.series:
        if 18 * series.size > _LARGEST:
            message = (
                f"channel {series.about.name!r} has {series.size} samples, more than MATLAB 5 files hold"
            )
            raise TethertestError(message, "ingest the run: MATLAB reads the store itself with h5read")
    names = valid_names(["run", *(series.about.name for series in run.series)])
    variables: dict[str, Any] = {
        names[0]: {
            "id": run.run,
            "title": run.title,
            "date": run.date.isoformat(),
            "run_file": run.header.run_file,
            "rig_file": run.header.rig_file,
            "software": _cells(f"{name} {version}" for name, version in run.header.software.items()),
            "flags": {(flag.name or "").lower(): float(flag) for flag in Flag if flag},
        }
    }
    for name, series in zip(names[1:], run.series, strict=True):
        variables[name] = _struct(series)
    savemat(cast("Any", file), variables, long_field_names=True, oned_as="column")
    file.seek(0)  # scipy writes the time of day here
    file.write(f"MATLAB 5.0 MAT-file, tethertest {__version__}".ljust(_HEAD).encode("ascii"))
    file.check()


def _struct(series: Series) -> dict[str, Any]:
    channel = series.read()
    source = channel.source
    struct: dict[str, Any] = {
        "name": channel.name,
        "kind": channel.kind,
        "unit": channel.unit,
        "time": channel.time,
        "value": channel.values,
        "flag": channel.flags,
        "at": np.nan if channel.at is None else channel.at,
        "uncertainty": channel.uncertainty,
        "noise": channel.noise,
    }
    if source is not None:
        for key in SOURCE_TEXTS:
            struct[key] = getattr(source, key)
        struct["steps"] = _cells(source.steps)
    return struct


def _cells(texts: Iterable[str]) -> np.ndarray:
    return np.array(list(texts), dtype=object)


def valid_names(names: Iterable[str]) -> list[str]:
    """Return different names that MATLAB takes for variables, as near to the given ones as it allows.

    Parameters
    ----------
    names : iterable of str
        Any text.
    """
    taken: set[str] = set()
    result: list[str] = []
    for name in names:
        text = re.sub(r"[^0-9A-Za-z_]", "_", name)
        if not re.match(r"[A-Za-z]", text) or text in _KEYWORDS:
            text = f"x{text}"
        candidate, number = text[:_LONGEST], 1
        while candidate.lower() in taken:  # some of MATLAB's programs do not tell case apart
            number += 1
            candidate = f"{text[: _LONGEST - len(str(number)) - 1]}_{number}"
        taken.add(candidate.lower())
        result.append(candidate)
    return result
