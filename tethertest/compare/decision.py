"""From an error, its uncertainty and a limit to a verdict with words.

The uncertainty of validation follows ASME V&V 20: ``u_val^2 = u_num^2 + u_input^2 + u_D^2``; of a cable that
goes slack the input nobody knows, how straight it hangs, is stated by itself. An error within
`RESOLUTION_FACTOR` u_val is "not resolved at this noise": the data cannot say how wrong the replay is, only
that it is no more wrong than that. It still passes a limit that is wider than error and uncertainty together.

References
----------
ASME V&V 20-2009, Standard for verification and validation in computational fluid dynamics and heat transfer.
JCGM 106:2012, The role of measurement uncertainty in conformity assessment (guard bands).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final, Literal

import numpy as np

from tethertest.records.comparison import Verdict

#: one-sided 95 %: the chance of a wrong pass or a wrong fail at the edge of the guard band is 5 %
GUARD_FACTOR: Final = 1.645
#: an error below this many u_val is not resolved
RESOLUTION_FACTOR: Final = 2.0


@dataclass(frozen=True, slots=True)
class Uncertainty:
    """Standard uncertainties of an error, by where they come from."""

    data: float = 0.0  #: calibration and noise of the measurement
    inputs: float = 0.0  #: uncertain parameters of the rig
    numerical: float = 0.0  #: of the replay's scheme
    slack: float = 0.0  #: what nobody knows of a slack cable: how straight it hangs, its damping

    @property
    def total(self) -> float:
        """u_val."""
        return float(np.sqrt(self.data**2 + self.inputs**2 + self.numerical**2 + self.slack**2))


def few_draws_factor(count: int) -> float:
    """Return what widens the spread of so few draws, so that `GUARD_FACTOR` of it covers one-sided 95 %.

    Student's quantile of as many degrees of freedom over the normal one: 1.43 for three draws.
    """
    from scipy.special import stdtrit

    return float(stdtrit(count, 0.95)) / GUARD_FACTOR


def decide(
    error: float,
    uncertainty: Uncertainty,
    limit: float | None,
    rule: Literal["guard", "simple"],
    angle: bool = False,
) -> tuple[Verdict, str]:
    """Hold an error against its limit.

    Parameters
    ----------
    error : float
        Of the replay against the measurement; only its size counts.
    uncertainty : Uncertainty
        Standard, in the unit of the error.
    limit : float or None
        Largest size that passes; None for a metric that informs only.
    rule : {"guard", "simple"}
        "guard": pass where ``|E| + 1.645 u <= limit``, fail where ``|E| - 1.645 u > limit``, else undecided.
        "simple": pass where ``|E| <= limit``, else fail.
    angle : bool
        The error is in rad, not relative.

    Returns
    -------
    Verdict, str
        With value, limit and distance in words.
    """
    size, total = abs(error), uncertainty.total
    parts = {"data": uncertainty.data, "rig": uncertainty.inputs, "numerical": uncertainty.numerical}
    if uncertainty.slack > 0.0:
        parts["slack"] = uncertainty.slack
    budget = ", ".join(f"{name} {_words(part, angle)}" for name, part in parts.items())
    unresolved = "; not resolved at this noise" if size <= RESOLUTION_FACTOR * total else ""
    sign = "-" if error < 0.0 else "+"
    found = f"error {sign}{_words(size, angle)} ± {_words(total, angle)} ({budget})"
    if limit is None:
        return Verdict.INFORMATIVE, f"{found}, no limit{unresolved}"
    found = f"{found}, limit {_words(limit, angle)}"
    margin = GUARD_FACTOR * total if rule == "guard" else 0.0
    if size + margin <= limit:
        return Verdict.PASS, f"{found}: inside by {_words(limit - size, angle)}{unresolved}"
    if size - margin > limit:
        return Verdict.FAIL, f"{found}: beyond by {_words(size - limit, angle)}{unresolved}"
    side = f"{'inside' if size <= limit else 'beyond'} by {_words(abs(limit - size), angle)}"
    return Verdict.UNDECIDED, f"{found}: {side}, which the uncertainty does not settle{unresolved}"


def _words(value: float, angle: bool) -> str:
    return f"{value:.2g} rad" if angle else f"{100.0 * value:.2g} %"
