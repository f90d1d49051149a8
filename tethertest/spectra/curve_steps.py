"""Jumps of an amplitude from one setting of the drive to the next.

A jump and a resonance narrower than the settings are apart look alike, so a jump is only called where a
smooth curve would not step so: above `SHARE` times each of the two steps on either side, in the amplitude and
in its logarithm. The flank of a resonance announces itself, and what a narrow peak adds, it takes away again:
however narrow it is and wherever it stands, a single one stays below 1.6 times.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np
from scipy.special import ndtri

from tethertest.records.across import Judgement, Step, StepVerdict
from tethertest.records.arrays import FloatArray

#: least ratio of a jump to the steps beside it
SHARE: Final = 2.5
#: least ratio of a step that may be a jump
STEEP: Final = 1.5
#: and its least size, against the larger of its two amplitudes
WORTH_A_WORD: Final = 0.1
#: standard errors that such a step is to be beyond
_TWO_ERRORS: Final = 2.0
#: settings of a branch: a gap has two more on each side
FEWEST_SETTINGS: Final = 6
#: standard errors, below which an amplitude counts linearly where the scatter is estimated
_LINEAR_BELOW: Final = 10.0
#: and the share of the curve's largest amplitude
_SMALLEST_SHARE: Final = 1e-3
#: share of the largest amplitude near a gap below which a step counts linearly, not by its logarithm
_KNEE: Final = 0.2
#: median of the magnitude of a standard normal deviate
_NORMAL_MEDIAN: Final = 0.6744897501960817
#: gaps on each side that a step is compared with
_REACH: Final = 2
#: contrasts of four settings that tell a scatter; else those of three do
_FEWEST_CONTRASTS: Final = 3
_STEP: Final = np.array([-1.0, 1.0])
_BETWEEN: Final = "runs at settings between them would tell"


def judge_steps(
    setting: FloatArray, amplitude: FloatArray, error: FloatArray, significance: float
) -> Judgement:
    """Find the jumps of one branch.

    Parameters
    ----------
    setting : (n,) float64
        Strictly increasing or strictly decreasing: frequencies [Hz] or amplitudes [m] of the drive.
    amplitude, error : (n,) float64
        Amplitude of a line and its standard error, in one unit.
    significance : float
        Chance of one false jump in the whole branch, if it is a smooth curve.

    Returns
    -------
    Judgement
        Jumps, and steps that may be one, by rising setting.

    Raises
    ------
    ValueError
        The settings are not strictly monotone, or the arrays differ in shape.

    Notes
    -----
    A step is a jump where it is above `SHARE` times each of its four neighbours by more than chance allows.
    Errors are the lines' own and the scatter of other settings about short parabolas: what repeats no better
    than that cannot show a jump.
    """
    _check(setting, amplitude, error)
    if setting.size < FEWEST_SETTINGS:
        refused = f"{setting.size} settings, expected {FEWEST_SETTINGS}"
        return Judgement((), significance, math.nan, refused)
    if setting[0] > setting[-1]:
        setting, amplitude, error = setting[::-1], amplitude[::-1], error[::-1]
    curve = _Curve.of(setting, amplitude, error)
    limit = float(-ndtri(significance / (2.0 * (setting.size - 1))))
    steps: list[Step] = []
    for gap in range(setting.size - 1):
        step = _jump(curve, gap, limit) or _steep(curve, gap) or _lone(curve, gap, limit)
        if step is not None:
            steps.append(step)
    return Judgement(tuple(steps), significance, curve.scatter(None))


def _check(setting: FloatArray, amplitude: FloatArray, error: FloatArray) -> None:
    if not setting.shape == amplitude.shape == error.shape or setting.ndim != 1:
        message = f"setting {setting.shape}, amplitude {amplitude.shape}, error {error.shape}: must be alike"
        raise ValueError(message)
    gaps = np.diff(setting)
    if gaps.size and not (np.all(gaps > 0.0) or np.all(gaps < 0.0)):
        message = "settings must rise or fall strictly"
        raise ValueError(message)


@dataclass(frozen=True, slots=True, eq=False)
class _Curve:
    """A branch by rising setting, in two scales: amplitudes as they are, and their logarithms."""

    setting: FloatArray  #: (n,)
    amplitude: FloatArray  #: (n,)
    error: FloatArray  #: (n,) of the amplitude
    logarithm: FloatArray  #: (n,) linear below the knee
    growth: FloatArray  #: (n,) change of the amplitude for one of its logarithm

    @classmethod
    def of(cls, setting: FloatArray, amplitude: FloatArray, error: FloatArray) -> _Curve:
        """Return the curve with its logarithms."""
        largest = float(np.max(np.abs(amplitude)))
        knee = max(_LINEAR_BELOW * float(np.median(error)), _SMALLEST_SHARE * largest) or 1.0
        logarithm = np.arcsinh(amplitude / knee)
        return cls(setting, amplitude, error, logarithm, np.hypot(amplitude, knee))

    def scatter(self, gap: int | None) -> float:
        """Return the standard deviation of the logarithms about short parabolas that do not cross a gap."""
        parts = (slice(0, None),) if gap is None else (slice(0, gap + 1), slice(gap + 1, None))
        error = self.error / self.growth
        for points in (4, 3):
            found = [
                _contrasts(self.setting[part], self.logarithm[part], error[part], points) for part in parts
            ]
            apart, known = (np.concatenate(side) for side in zip(*found, strict=True))
            if apart.size >= _FEWEST_CONTRASTS or (points == 3 and apart.size):
                spread = float(np.median(np.abs(apart))) / _NORMAL_MEDIAN
                return math.sqrt(max(0.0, spread**2 - float(np.median(known**2))))
        return 0.0

    def scales(self, gap: int, scatter: float) -> tuple[tuple[FloatArray, FloatArray], ...]:
        """Return amplitudes and errors as they are, and bent as by a logarithm, near a gap."""
        error = np.hypot(self.error, scatter * self.growth)
        near = self.amplitude[max(0, gap - _REACH) : gap + _REACH + 2]
        knee = _KNEE * float(np.max(np.abs(near))) or 1.0
        bent = np.arcsinh(self.amplitude / knee)
        return (self.amplitude, error), (bent, error / np.hypot(self.amplitude, knee))

    def fair(self, gap: int, other: int) -> float:
        """Return what another step may count: a wider gap may hold more, a narrower one gets no credit."""
        width = np.diff(self.setting)
        return max(1.0, float(width[gap] / width[other]))

    def beyond(self, gap: int, others: Sequence[int], share: float) -> float:
        """Return by how many standard errors a step is above a share of others, where that is least.

        Which way another step truly goes is not known, so the step is above it either way.
        """
        found = math.inf
        for value, error in self.scales(gap, self.scatter(gap)):
            for other in others:
                for way in (-share, share):
                    weight = np.zeros_like(value)
                    weight[gap : gap + 2] += math.copysign(1.0, value[gap + 1] - value[gap]) * _STEP
                    weight[other : other + 2] += way * self.fair(gap, other) * _STEP
                    more, spread = float(weight @ value), float(np.sqrt(np.sum((weight * error) ** 2)))
                    found = min(found, more / spread if spread > 0.0 else math.copysign(math.inf, more))
        return found

    def ratio(self, gap: int, others: Sequence[int]) -> float:
        """Return a step over the largest of others, in the scale where that is least."""
        found = math.inf
        for value, _ in self.scales(gap, 0.0):
            steps = np.abs(np.diff(value))
            beside = max(float(steps[other]) * self.fair(gap, other) for other in others)
            found = min(found, float(steps[gap]) / beside if beside > 0.0 else math.inf)
        return found

    def beside(self, gap: int) -> tuple[int, ...]:
        """Return the gaps on both sides of one."""
        places = (gap - _REACH, *range(gap - _REACH + 1, gap), *range(gap + 1, gap + _REACH + 1))
        return tuple(other for other in places if 0 <= other < self.setting.size - 1)

    def large(self, first: int, last: int) -> bool:
        """Return whether the amplitude changes enough from one setting to another to speak of it."""
        ends = self.amplitude[first], self.amplitude[last]
        return abs(float(ends[1] - ends[0])) > WORTH_A_WORD * max(abs(float(end)) for end in ends)

    def step(self, first: int, last: int, verdict: StepVerdict, reason: str) -> Step:
        """Return the step from one setting to another."""
        return Step(
            (float(self.setting[first]), float(self.setting[last])),
            (float(self.amplitude[first]), float(self.amplitude[last])),
            verdict,
            self.ratio(first, self.beside(first)),
            reason,
        )


def _contrasts(
    setting: FloatArray, value: FloatArray, error: FloatArray, points: int
) -> tuple[FloatArray, FloatArray]:
    """Return what no polynomial through one point less carries, and its standard errors.

    Both are scaled so that values with one standard deviation give contrasts with the same.
    """
    if setting.size < points:
        return np.empty(0), np.empty(0)
    part, values, errors = (
        np.lib.stride_tricks.sliding_window_view(array, points) for array in (setting, value, error)
    )
    apart = part[:, :, np.newaxis] - part[:, np.newaxis, :]
    apart /= (part[:, -1] - part[:, 0])[:, np.newaxis, np.newaxis]
    apart[:, range(points), range(points)] = 1.0
    weight = 1.0 / np.prod(apart, axis=2)
    weight /= np.sqrt(np.sum(weight**2, axis=1, keepdims=True))
    return np.sum(weight * values, axis=1), np.sqrt(np.sum((weight * errors) ** 2, axis=1))


def _jump(curve: _Curve, gap: int, limit: float) -> Step | None:
    """Return a step that no smooth curve makes."""
    beside = curve.beside(gap)
    ratio = curve.ratio(gap, beside)
    if ratio <= SHARE:
        return None
    least = curve.beyond(gap, beside, SHARE)
    if least <= limit:
        return None
    if len(beside) == 2 * _REACH:
        reason = (
            f"{ratio:.3g} times the steps beside it; a smooth curve makes at most {SHARE:g}, and the rest is "
            f"{least:.3g} standard errors, chance gives {limit:.3g}"
        )
        return curve.step(gap, gap + 1, StepVerdict.JUMP, reason)
    reason = f"{ratio:.3g} times the steps beside it, near the end of the settings: runs beyond it would tell"
    return curve.step(gap, gap + 1, StepVerdict.UNDECIDED, reason) if curve.large(gap, gap + 1) else None


def _steep(curve: _Curve, gap: int) -> Step | None:
    """Return a step that may be a jump, or a flank that is not resolved."""
    beside = curve.beside(gap)
    if len(beside) < 2 * _REACH or not curve.large(gap, gap + 1) or curve.ratio(gap, beside) <= STEEP:
        return None
    if curve.beyond(gap, beside, STEEP) <= _TWO_ERRORS:
        return None
    reason = (
        f"{curve.ratio(gap, beside):.3g} times the steps beside it: a jump makes more than {SHARE:g} beyond "
        f"errors, a flank steeper than the settings resolve as much; {_BETWEEN}"
    )
    return curve.step(gap, gap + 1, StepVerdict.UNDECIDED, reason)


def _lone(curve: _Curve, gap: int, limit: float) -> Step | None:
    """Return two steps in a row that stand out: one setting high, low or halfway."""
    outer = (gap - 1, gap + 2)
    if outer[0] < 0 or outer[1] > curve.setting.size - 2:
        return None
    if min(curve.ratio(one, outer) for one in (gap, gap + 1)) <= SHARE:
        return None
    if min(curve.beyond(one, outer, SHARE) for one in (gap, gap + 1)) <= limit:
        return None
    first, second = np.diff(curve.amplitude)[gap : gap + 2]
    if first * second > 0.0:
        reason = f"two steps in a row stand out: a jump beside a flank, or a flank alone; {_BETWEEN}"
    else:
        reason = (
            f"the setting between stands alone: a resonance narrower than the settings are apart, or one run "
            f"that differs; {_BETWEEN}"
        )
    return curve.step(gap, gap + 2, StepVerdict.UNDECIDED, reason)
