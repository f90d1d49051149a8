"""How far a model's groups are from its prototype's."""

from __future__ import annotations

import math
from dataclasses import replace

from tethertest.records.similarity import PiGroup

#: largest factor between two values of a group that counts as matched, and as mild
MATCHED_WITHIN = 1.05
MILD_WITHIN = 2.0

MATCHED = "matched"
MILD = "mild"
VIOLATED = "violated"


def level(ratio: float) -> str:
    """Return how distorted a group is: ``matched``, ``mild`` or ``violated``.

    Parameters
    ----------
    ratio : float
        Value of the group in the model over that in the prototype [1]; 0 and infinity are violations.

    Notes
    -----
    A group can also be ``irrelevant``, but only a sensitivity can say so; this function never does.
    """
    if not 0.0 < ratio < math.inf:
        return VIOLATED
    factor = max(ratio, 1.0 / ratio)
    if factor <= MATCHED_WITHIN:
        return MATCHED
    return MILD if factor <= MILD_WITHIN else VIOLATED


def judged(group: PiGroup, model: float, prototype: float) -> PiGroup:
    """Return a group with its values at both scales, their ratio and its level.

    Parameters
    ----------
    group : PiGroup
        Name, exponents and meaning.
    model, prototype : float
        Values [1], not both zero. What the prototype has not at all has no ratio and is violated.
    """
    ratio = model / prototype if prototype != 0.0 else None
    found = VIOLATED if ratio is None else level(ratio)
    return replace(group, model=model, prototype=prototype, ratio=ratio, level=found)
