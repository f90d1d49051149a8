"""Whether an order of the response is what the bottom motion brings in."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from typing import Final

from tethertest.records.lines import Expectation, Line, LineVerdict

#: relative tolerance on an amount that kinematics and the linear response predict: twice what a rig known to
#: 1 % and an order-2 response within 10 % leave open
KINEMATIC_TOLERANCE: Final = 0.25
#: factor either way on an amount estimated from the transfer at order 1 alone, beyond stiffness-like
#: (constant) and inertia-like (square of the order) transfer
TRANSFER_TOLERANCE: Final = 2.0
#: a predicted ratio below this is round-off of the kinematics
NOTHING: Final = 1e-9
#: verdicts under which a line of the input is not there
ABSENT: Final = (
    LineVerdict.NONE,
    LineVerdict.NOT_RESOLVABLE,
    LineVerdict.LEAKAGE,
    LineVerdict.UNDETERMINED,
)


@dataclass(frozen=True, slots=True)
class Explanation:
    """What the input says about one order of the response."""

    explained: bool
    text: str  #: for the reason; empty where the input says nothing


def explain_by_input(
    order: Fraction, amplitude: float, standard_error: float, fundamental: float, expectation: Expectation
) -> Explanation:
    """Compare the amplitude of an order with what the bottom motion brings.

    Where the expectation holds a predicted ratio to order 1 (kinematics through the linear response) that
    decides; else the measured motion at that order, carried over by the transfer at order 1.

    Parameters
    ----------
    order : Fraction
        Order of the drive.
    amplitude, standard_error, fundamental : float
        Of the order and of order 1, in the channel's unit.
    expectation : Expectation
        What is known beforehand.

    Returns
    -------
    Explanation
        Explained or not, with the numbers in words.
    """
    ratio = amplitude / max(fundamental, 1e-300)
    slack = 2.0 * standard_error / max(fundamental, 1e-300)
    predicted = expectation.crank_orders.get(str(order))
    if predicted is not None:
        close = abs(ratio - predicted) <= KINEMATIC_TOLERANCE * predicted + slack
        words = f"{predicted:.3g} of order 1" if predicted > NOTHING else "nothing at this order"
        text = f"bottom motion and linear response predict {words}, found {ratio:.3g}"
        return Explanation(close, text)
    own, base = _input_line(expectation, order), _input_line(expectation, Fraction(1))
    if own is None or base is None or base.amplitude <= 0.0:
        return Explanation(False, "")
    carried = own.amplitude / base.amplitude
    square = float(order) ** 2
    least = carried * min(1.0, square) / TRANSFER_TOLERANCE
    most = carried * max(1.0, square) * TRANSFER_TOLERANCE
    text = (
        f"the measured bottom motion carries {carried:.3g} of its order 1, which accounts for {least:.2g} to "
        f"{most:.2g} of order 1 here; found {ratio:.3g}"
    )
    return Explanation(least - slack <= ratio <= most + slack, text)


def _input_line(expectation: Expectation, order: Fraction) -> Line | None:
    if expectation.input_lines is None:
        return None
    line = expectation.input_lines.line(str(order))
    return None if line is None or line.verdict in ABSENT else line
