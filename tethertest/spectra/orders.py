"""The orders of the drive that are looked for, and which of them a record can tell apart."""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from functools import lru_cache
from typing import Final

#: orders that get a line and a verdict; Holm's correction counts them
ORDERS: Final = tuple(Fraction(text) for text in ("1/3", "1/2", "2/3", "1", "3/2", "2", "5/2", "3", "4", "5"))
#: orders fitted along with them without a verdict, so that their leakage does not enter the noise
COMPANIONS: Final = tuple(Fraction(text) for text in ("7/2", "9/2", "6", "7", "8", "9", "10"))
#: two fitted frequencies must be this many 1/T apart
RESOLUTION: Final = 1.0
#: and the lowest this many 1/T from zero, where the drift is
LOWEST_CYCLES: Final = 2.0
#: relative; keeps orders that are apart by exactly the resolution
ROUND_OFF: Final = 1e-9


def resolvable_orders(
    orders: Sequence[Fraction], frequency: float, length: float, highest: float
) -> tuple[Fraction, ...]:
    """Return the orders a record can tell apart, whole ones first choice, then halves, then thirds.

    Parameters
    ----------
    orders : sequence of Fraction
        Those wanted.
    frequency : float
        Of the drive [Hz].
    length : float
        Of the record [s].
    highest : float
        Highest frequency the series carries [Hz].

    Returns
    -------
    tuple of Fraction
        In rising order.
    """
    periods = frequency * length * (1.0 + ROUND_OFF)
    accepted: dict[float, Fraction] = {}
    for order in _by_preference(tuple(orders)):
        place = float(order)
        apart = min((abs(place - other) for other in accepted), default=place)
        clear = apart * periods >= RESOLUTION and place * periods >= LOWEST_CYCLES
        if clear and place * frequency < highest:
            accepted[place] = order
    return tuple(accepted[place] for place in sorted(accepted))


@lru_cache(maxsize=32)
def _by_preference(orders: tuple[Fraction, ...]) -> tuple[Fraction, ...]:
    return tuple(sorted(orders, key=lambda order: (order.denominator, order)))


def length_to_resolve(order: Fraction, orders: Sequence[Fraction], frequency: float) -> float:
    """Return the record length [s] that tells an order from zero and from the nearest other order."""
    nearest = min(abs(order - other) for other in orders if other != order)
    return max(RESOLUTION / float(nearest), LOWEST_CYCLES / float(order)) / frequency
