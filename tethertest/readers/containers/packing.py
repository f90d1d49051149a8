"""Numbers that a data set holds packed, as the CF conventions of netCDF have it.

References
----------
Eaton et al., "NetCDF Climate and Forecast (CF) Metadata Conventions", section 8.1, packed data.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import prod
from typing import Any, Final

import numpy as np

from tethertest.readers.containers.table import Numbers

_SCALE, _OFFSET = "scale_factor", "add_offset"
_MISSING: Final = ("_FillValue", "missing_value")


@dataclass(frozen=True, slots=True)
class Packing:
    """What makes the numbers of a data set its values."""

    scale: float = 1.0
    offset: float = 0.0
    missing: tuple[float, ...] = ()  #: numbers that stand for no value

    @property
    def remark(self) -> str:
        """What is done, in words; "" where nothing is."""
        said = []
        if (self.scale, self.offset) != (1.0, 0.0):
            said.append(
                f"values are {_SCALE} {self.scale:g} times what is stored, plus {_OFFSET} {self.offset:g}"
            )
        if self.missing:
            said.append(f"{' and '.join(f'{value:g}' for value in self.missing)} read as missing")
        return ", ".join(said)

    def unpacked(self, stored: Numbers) -> Numbers:
        """Return the values: as stored where nothing is packed, else as float64 with NaN for missing."""
        if self == PLAIN or stored.dtype.kind not in "iuf":
            return stored
        values = stored.astype(np.float64) * self.scale + self.offset
        for number in self.missing:
            values[stored == number] = np.nan
        return values


PLAIN: Final = Packing()


def packing_of(item: Any) -> Packing:
    """Return how a data set of h5py is packed, by its attributes of one number."""
    scale, offset = (_numbers(item, key) for key in (_SCALE, _OFFSET))
    missing = {number for key in _MISSING for number in _numbers(item, key)}
    return Packing(scale[0] if scale else 1.0, offset[0] if offset else 0.0, tuple(sorted(missing)))


def _numbers(item: Any, key: str) -> tuple[float, ...]:
    if key not in item.attrs:
        return ()
    attribute = item.attrs.get_id(key)
    if prod(attribute.shape) != 1 or attribute.dtype.kind not in "iuf":
        return ()
    number = float(np.asarray(item.attrs[key]).reshape(-1)[0])
    return (number,) if np.isfinite(number) else ()
