"""Quantities that a user gives on the command line."""

from __future__ import annotations

from tethertest.errors import QuantityError
from tethertest.records.quantity import SI

#: drives that a rig can have
FREQUENCY = SI("Hz", above=0.0, maximum=1e4)
AMPLITUDE = SI("m", above=0.0, maximum=1e3)
#: relative errors worth asking for
TOLERANCE = SI("1", above=0.0, maximum=1.0)


def parse_option(option: str, text: str, expected: SI) -> float:
    """Return an option's value in SI.

    Raises
    ------
    QuantityError
        With the option's name.
    """
    try:
        return expected.parse(text)
    except QuantityError as error:
        message = f"{option}: {error.problem}"
        raise QuantityError(message, error.remedy) from error
