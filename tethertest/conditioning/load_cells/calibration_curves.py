"""Calibration pairs -> a curve of force against output, with what is not known about it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from tethertest.errors import DataError
from tethertest.records.arrays import BoolArray, FloatArray
from tethertest.records.calibration import Calibration, CalibrationData, CalibrationPoint
from tethertest.records.channel import Severity

#: chance of calling a good calibration bad, in each test
SIGNIFICANCE = 0.01
#: beyond the calibrated span a curve is continued straight over this share of it, for noise about its ends;
#: what lies farther out was never calibrated
CONTINUED = 0.05
#: forces closer than this share of the span are the same load
SAME_LOAD = 1e-3
#: residuals below this share of the span are rounding
ROUNDING = 1e-12
#: half-width of 95 % of a normal distribution, in standard deviations
NORMAL_95 = 1.96


@dataclass(frozen=True, slots=True, eq=False)
class Curve:
    """Force as a function of a load cell's output ``x``, through ``z = (x - middle)/half`` in [-1, 1]."""

    kind: str  #: of the output: "ratio", "voltage" or "count"
    middle: float
    half: float
    coefficients: FloatArray  #: (k,) [N], lowest power of z first; empty for straight lines between knots
    covariance: FloatArray  #: (k, k) [N^2]
    knots: tuple[FloatArray, FloatArray]  #: outputs and forces, for straight lines; empty for a polynomial
    relative: float  #: standard uncertainty of a force difference over the whole span, relative
    scatter: float  #: standard deviation of one reading about the curve [N]
    hysteresis: float  #: largest difference between unloading and loading [N]
    repeatability: float  #: standard deviation at the same load, taken the same way [N]
    words: str
    problems: tuple[tuple[str, str, Severity], ...] = ()  #: kind, text and severity of each finding

    @property
    def offset_uncertainty(self) -> float:
        """Standard uncertainty of a reading about the curve [N]: scatter, and half the hysteresis either way.

        The hysteresis is a rectangle of half-width h/2 (JCGM 100:2008, 4.3.7).
        """
        return float(np.hypot(self.scatter, self.hysteresis / (2.0 * np.sqrt(3.0))))

    def force(self, output: FloatArray) -> FloatArray:
        """Return the force [N] of outputs, continued straight beyond the calibrated span."""
        if self.coefficients.size:
            z = (output - self.middle) / self.half
            inside = np.clip(z, -1.0, 1.0)
            slope = np.polynomial.polynomial.polyval(inside, _derivative(self.coefficients))
            value = np.polynomial.polynomial.polyval(inside, self.coefficients) + slope * (z - inside)
            return np.asarray(value, dtype=np.float64)
        outputs, forces = self.knots
        piece = np.clip(np.searchsorted(outputs, output) - 1, 0, outputs.size - 2)
        slope = np.diff(forces) / np.diff(outputs)
        return np.asarray(forces[piece] + slope[piece] * (output - outputs[piece]), dtype=np.float64)

    def beyond(self, output: FloatArray) -> BoolArray:
        """Return which outputs lie farther outside the calibrated span than it may be continued."""
        return np.asarray(np.abs(output - self.middle) > (1.0 + 2.0 * CONTINUED) * self.half, dtype=bool)


def curve_of(data: CalibrationData, asked: Calibration) -> Curve:
    """Return the curve through calibration pairs.

    Parameters
    ----------
    data : CalibrationData
        The pairs, in the order in which they were taken.
    asked : Calibration
        Order of the polynomial, least squares of force on output; without one straight lines between the
        pairs. Relative uncertainty of the references.

    Returns
    -------
    Curve
        Its findings name a residual that is no chance, an outlier, and uncertainty that nobody stated.

    Raises
    ------
    DataError
        Too few pairs, or pairs that do not rise.
    """
    measured = np.array([point.measured for point in data.points])
    force = np.array([point.force for point in data.points])
    distinct = np.unique(measured).size
    needed = 2 if asked.order is None else asked.order + 1
    if distinct < needed or np.ptp(force) == 0.0:
        message = f"the calibration of {data.source} has {distinct} different outputs, needed {needed}"
        raise DataError(message, "calibrate at more loads, or lower the order")
    if asked.order is None:
        return _lines(data, asked, measured, force)
    return _polynomial(data, asked, measured, force, asked.order)


def _lines(data: CalibrationData, asked: Calibration, measured: FloatArray, force: FloatArray) -> Curve:
    row = np.argsort(measured, kind="stable")
    outputs, forces = measured[row], force[row]
    steps = np.diff(forces)
    if np.any(np.diff(outputs) == 0.0) or not (np.all(steps > 0.0) or np.all(steps < 0.0)):
        message = f"the pairs of {data.source} do not rise from one to the next: they are no table"
        raise DataError(message, "give the order of a polynomial to fit, such as order = 1")
    span = float(np.ptp(forces))
    stated = _stated(data.points)
    ends = 0.0 if stated is None else float(np.hypot(stated[row[0]], stated[row[-1]]))
    relative = float(np.hypot(ends / span, asked.reference or 0.0))
    words = f"straight lines through {outputs.size} pairs"
    problems = _unknown(stated is None and asked.reference is None, data)
    return Curve(
        data.kind,
        0.5 * (outputs[0] + outputs[-1]),
        0.5 * float(outputs[-1] - outputs[0]),
        np.zeros(0),
        np.zeros((0, 0)),
        (outputs, forces),
        relative,
        0.0 if stated is None else float(np.max(stated)),
        0.0,
        0.0,
        f"{words}, relative uncertainty {relative:.2g}",
        problems,
    )


def _polynomial(
    data: CalibrationData, asked: Calibration, measured: FloatArray, force: FloatArray, order: int
) -> Curve:
    from scipy.stats import chi2, t

    middle, half = 0.5 * (measured.min() + measured.max()), 0.5 * float(np.ptp(measured))
    z = (measured - middle) / half
    stated = _stated(data.points)
    root = np.ones(z.size) if stated is None else 1.0 / stated
    design = np.vander(z, order + 1, increasing=True)
    coefficients, inverse, residual = _least_squares(design, force, root)
    freedom = z.size - order - 1
    squares = float(np.sum((root * residual) ** 2))
    rounding = (ROUNDING * float(np.ptp(force))) ** 2
    problems: list[tuple[str, str, Severity]] = []
    scatter = float(np.sqrt(np.sum(residual**2) / freedom)) if freedom else 0.0
    if stated is None:
        # few residuals know their own size badly: the interval of Student's t keeps its 95 %
        student = float(t.ppf(0.975, freedom)) / NORMAL_95 if freedom else 0.0
        covariance = inverse * (squares / max(freedom, 1)) * student**2
    else:
        covariance = inverse * max(1.0, squares / max(freedom, 1))
        if freedom and float(chi2.sf(squares, freedom)) < SIGNIFICANCE:
            ratio = np.sqrt(squares / freedom)
            text = f"the residuals of its calibration are {ratio:.3g} times their stated uncertainties"
            problems.append(("calibration_residuals", text, Severity.WARNING))
    if freedom and squares > rounding * float(np.max(root)) ** 2:
        problems += _outlier(data, design * root[:, None], residual * root, squares, freedom)
        problems += _misfit(data, design, force, root, squares, freedom)
    problems += _unknown(freedom == 0 and stated is None and asked.reference is None, data)
    across = 1.0 - (-1.0) ** np.arange(order + 1)  # powers of z at its upper end less those at its lower
    span = float(across @ coefficients)
    if np.any(np.diff(np.polynomial.polynomial.polyval(np.linspace(-1, 1, 101), coefficients)) * span <= 0.0):
        message = f"the polynomial of order {order} through {data.source} turns back inside its own span"
        raise DataError(message, "lower the order, or correct the pairs")
    relative = float(np.hypot(np.sqrt(across @ covariance @ across) / abs(span), asked.reference or 0.0))
    hysteresis, repeatability = _hysteresis(force, residual), _repeatability(force, residual)
    gain = coefficients[1] / half if order == 1 else span / (2.0 * half)
    words = (
        f"least squares of order {order} through {z.size} pairs, {gain:.7g} N per unit of output"
        f"{' over the span' if order > 1 else ''} (relative uncertainty {relative:.2g}), "
        f"scatter {scatter:.3g} N, hysteresis {hysteresis:.3g} N, repeatability {repeatability:.3g} N"
    )
    return Curve(
        data.kind,
        middle,
        half,
        coefficients,
        covariance,
        (np.zeros(0), np.zeros(0)),
        relative,
        scatter,
        hysteresis,
        repeatability,
        words,
        tuple(problems),
    )


def _least_squares(
    design: FloatArray, force: FloatArray, root: FloatArray
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return coefficients, the inverse of the normal matrix, and residuals force - curve."""
    q, r = np.linalg.qr(design * root[:, None])
    coefficients = np.linalg.solve(r, q.T @ (force * root))
    half = np.linalg.inv(r)
    return coefficients, half @ half.T, force - design @ coefficients


def _outlier(
    data: CalibrationData, design: FloatArray, weighted: FloatArray, squares: float, freedom: int
) -> list[tuple[str, str, Severity]]:
    """Name a pair whose deleted studentised residual is no chance (Bonferroni over all pairs)."""
    from scipy.stats import t

    if freedom < 3:
        return []
    q = np.linalg.qr(design)[0]
    left = np.maximum(1.0 - np.sum(q**2, axis=1), ROUNDING)
    others = np.maximum(squares - weighted**2 / left, 0.0) / (freedom - 1)
    with np.errstate(divide="ignore"):
        student = np.abs(weighted) / np.sqrt(left * others)
    worst = int(np.argmax(student))
    if weighted.size * 2.0 * float(t.sf(student[worst], freedom - 1)) >= SIGNIFICANCE:
        return []
    point = data.points[worst]
    text = (
        f"{point.place} of its calibration ({point.measured:.7g}, {point.force:.6g} N) is an outlier: "
        f"{student[worst]:.1f} standard deviations off the other pairs; it was used, so look at it"
    )
    return [("calibration_outlier", text, Severity.WARNING)]


def _misfit(
    data: CalibrationData,
    design: FloatArray,
    force: FloatArray,
    root: FloatArray,
    squares: float,
    freedom: int,
) -> list[tuple[str, str, Severity]]:
    """Name residuals that one order more would explain (F test)."""
    from scipy.stats import f

    if freedom < 3 or np.unique(design[:, 1]).size <= design.shape[1]:
        return []
    higher = np.column_stack((design, design[:, 1] ** design.shape[1]))
    left = float(np.sum((root * _least_squares(higher, force, root)[2]) ** 2))
    ratio = (squares - left) / max(left / (freedom - 1), np.finfo(float).tiny)
    if float(f.sf(ratio, 1, freedom - 1)) >= SIGNIFICANCE:
        return []
    order = design.shape[1] - 1
    text = (
        f"the residuals of its calibration ({data.source}) follow a curve of order {order + 1}, and order "
        f"{order} was asked for: what is left reaches the uncertainty"
    )
    return [("calibration_misfit", text, Severity.WARNING)]


def _hysteresis(force: FloatArray, residual: FloatArray) -> float:
    """Return the largest difference between unloading and loading at the same load [N]; 0 without both."""
    rising = _rising(force)
    up, down = np.flatnonzero(rising), np.flatnonzero(~rising)
    if up.size < 2 or not down.size:
        return 0.0
    row = up[np.argsort(force[up], kind="stable")]
    inside = (force[down] >= force[row[0]]) & (force[down] <= force[row[-1]])
    loading = np.interp(force[down], force[row], residual[row])
    return float(np.max(np.abs(residual[down] - loading)[inside], initial=0.0))


def _rising(force: FloatArray) -> BoolArray:
    """Return which pairs were taken while loading; a load read again keeps the way it came."""
    step = np.diff(force, prepend=force[0])
    step[np.abs(step) <= SAME_LOAD * float(np.ptp(force))] = 0.0
    last = np.maximum.accumulate(np.where(step != 0.0, np.arange(force.size), 0))
    return np.asarray(step[last] >= 0.0, dtype=bool)


def _repeatability(force: FloatArray, residual: FloatArray) -> float:
    """Return the pooled standard deviation of residuals at the same load approached the same way [N]."""
    rising = _rising(force)
    load = np.round(force / (SAME_LOAD * float(np.ptp(force)))).astype(np.int64)
    squares, freedom = 0.0, 0
    for key in set(zip(load.tolist(), rising.tolist(), strict=True)):
        group = residual[(load == key[0]) & (rising == key[1])]
        squares += float(np.sum((group - group.mean()) ** 2))
        freedom += group.size - 1
    return float(np.sqrt(squares / freedom)) if freedom else 0.0


def _stated(points: tuple[CalibrationPoint, ...]) -> FloatArray | None:
    spreads = [point.uncertainty for point in points if point.uncertainty]
    return np.array(spreads) if len(spreads) == len(points) else None


def _unknown(unknown: bool, data: CalibrationData) -> tuple[tuple[str, str, Severity], ...]:
    if not unknown:
        return ()
    text = f"the calibration of {data.source} states no uncertainty and has no residuals: it counts as exact"
    return (("calibration_uncertainty", text, Severity.NOTE),)


def _derivative(coefficients: FloatArray) -> FloatArray:
    return np.asarray(np.polynomial.polynomial.polyder(coefficients), dtype=np.float64)
