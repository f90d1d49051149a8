"""Exact linear response at gauges: one transfer function per station, one transform in time, no mesh.

The input is sampled, weighted by ``exp(-eta t)``, transformed, multiplied by the transfer functions on the
line ``s = eta + i w`` and transformed back. What the period of the discrete transform wraps around is smaller
by ``exp(-eta period)``; rounding grows by ``exp(eta duration)``. The input is led smoothly to zero after the
record's end: what happens there cannot be seen before. The fronts of a sudden start are split off.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from tethertest.records.arrays import FloatArray
from tethertest.solver.linear.coupled import ComplexArray, CoupledCable, EndBody
from tethertest.solver.linear.coupled_fronts import (
    check_sudden,
    kink_spectrum,
    start_velocity,
    straight_strains,
)
from tethertest.solver.linear.coupled_transfer import strain_transfer
from tethertest.solver.norms import relative_difference

#: period of the transform over the duration; the input ends within the difference
_PERIOD = 2.0
#: what wraps around is smaller by exp(-this); what the sampling leaves grows by exp(this/period) at the end
_WRAP = 20.0
#: input samples beyond the record, at least
_SPARE = 16
#: input samples per output time, coarse to fine; each answer is the finer of a neighbouring pair
FACTORS = (1, 2, 4, 8, 16, 32, 64)
#: input samples per axial traverse that a sudden start needs before a pair of samplings can be trusted
_TRAVERSE_SAMPLES = 4.0


@dataclass(frozen=True, slots=True, eq=False)
class CoupledResponse:
    """Response of the linear cable at its stations; strains are counted from rest."""

    time: FloatArray  #: (n,) [s]
    stations: FloatArray  #: (g,) fraction of the length from the bottom
    tangential_strain: FloatArray  #: (n, g) eps1
    normal_strain: FloatArray  #: (n, g) eps2
    tension: FloatArray  #: (n, g) [N], total: |(P + EA eps) (1 + eps1, eps2)|, damping included
    printed_tension: FloatArray  #: (n, g) [N], the paper's dynamic tension EA eps
    strain: FloatArray  #: (n, g) change of the stretch of the unstretched cable, as a grating reads it
    top_displacement: FloatArray  #: (n, 2) [m] of the upper end along (tangent, normal) there


def refined_response(
    cable: CoupledCable,
    motion: Callable[[FloatArray], FloatArray],
    direction: tuple[float, float],
    stations: FloatArray,
    *,
    rows: int,
    rate: float,
    tolerance: float,
    top: EndBody | None = None,
) -> tuple[CoupledResponse, float, int]:
    """Return the response, its relative error and the input samples per output time that it took.

    Parameters are those of `exact_response`; the transfer functions of a coarse sampling are the first half
    of those of the next, and are computed once. The error is the difference of the last two samplings,
    infinite where a sudden start makes waves along the cable that the finest sampling does not follow.
    """
    line = TransformLine.over(rows, rate)
    outputs = _Outputs.empty(stations, direction, top)
    coarse: CoupledResponse | None = None
    fronts: FloatArray | None = None
    velocity: float | None = None
    error = math.inf
    for factor in FACTORS:
        drive = TransformDrive.sampled(motion, line, factor, velocity)
        velocity = drive.start_velocity
        outputs = outputs.extended(cable, line.frequencies(factor))
        if fronts is None:
            fronts = outputs.fronts(cable, line, drive)
        fine = outputs.response(cable, line, drive, fronts)
        if coarse is not None:
            error = relative_difference(coarse.tension, fine.tension, cable.tension)
            if drive.start_velocity and cable.length < _TRAVERSE_SAMPLES * drive.step * cable.axial_speed:
                error = math.inf  # both of the pair miss the same reflections
            if error <= tolerance:
                break
        coarse = fine
    return fine, error, factor


def exact_response(
    cable: CoupledCable,
    motion: Callable[[FloatArray], FloatArray],
    direction: tuple[float, float],
    stations: FloatArray,
    *,
    rows: int,
    rate: float,
    factor: int = 1,
    top: EndBody | None = None,
) -> CoupledResponse:
    """Return the response to a bottom motion, smooth but for a velocity that it may start with.

    Parameters
    ----------
    cable : CoupledCable
    motion : callable
        Bottom displacement [m] at times (m,) [s]; it is asked to about twice the duration.
    direction : (float, float)
        Components of the motion along the tangent and the normal at the bottom.
    stations : (g,) float64
        Fractions of the length from the bottom.
    rows : int
        Number of output times k/rate.
    rate : float
        Output rate [Hz].
    factor : int
        Input samples per output time.
    top : EndBody, optional
        Body at the top; fixed if absent.

    Raises
    ------
    DataError
        The motion starts with a displacement, or with a velocity on a damped cable.
    """
    line = TransformLine.over(rows, rate)
    outputs = _Outputs.empty(stations, direction, top).extended(cable, line.frequencies(factor))
    drive = TransformDrive.sampled(motion, line, factor)
    return outputs.response(cable, line, drive, outputs.fronts(cable, line, drive))


@dataclass(frozen=True, slots=True)
class TransformLine:
    """The line ``s = eta + i w`` and the samples in time that belong to it."""

    rows: int
    rate: float  #: [Hz]
    size: int  #: samples of one period at the output rate, even

    @classmethod
    def over(cls, rows: int, rate: float) -> TransformLine:
        """Return the line for so many output rows [Hz]."""
        from scipy.fft import next_fast_len

        return cls(rows, rate, 2 * int(next_fast_len(math.ceil(0.5 * (_PERIOD * rows + _SPARE)), real=True)))

    @property
    def eta(self) -> float:
        """Decay of the exponential window [1/s]."""
        return _WRAP * self.rate / self.size

    def frequencies(self, factor: int) -> ComplexArray:
        """Return ``s`` of the discrete transform of so many input samples per output time."""
        index = np.arange(self.size * factor // 2 + 1)
        return np.asarray(self.eta + 2j * np.pi * index * self.rate / self.size)


@dataclass(frozen=True, slots=True, eq=False)
class TransformDrive:
    """The bottom motion as the transform takes it."""

    motion: Callable[[FloatArray], FloatArray]
    start_velocity: float  #: [m/s], 0 for a smooth start
    factor: int  #: samples per output time
    step: float  #: [s] between samples
    weighted: FloatArray  #: (n,) [m], one period, led to zero after the record, times exp(-eta t)

    @classmethod
    def sampled(
        cls,
        motion: Callable[[FloatArray], FloatArray],
        line: TransformLine,
        factor: int,
        velocity: float | None = None,
    ) -> TransformDrive:
        """Sample the motion; ``velocity`` is that of the start, found from the samples if absent."""
        step = 1.0 / (line.rate * factor)
        time = np.asarray(np.arange(line.size * factor) * step, dtype=np.float64)
        values = np.array(motion(time), dtype=np.float64)
        kept = (line.rows - 1) * factor + 1
        if velocity is None:
            velocity = start_velocity(motion, values[:kept], step)
        ratio = (np.arange(time.size - kept) + 1.0) / (time.size - kept + 1.0)
        steepness = np.minimum(1.0 / (1.0 - ratio) - 1.0 / ratio, 700.0)  # beyond, the fade is 0 anyway
        values[kept:] /= 1.0 + np.exp(steepness)  # all derivatives of this step vanish at its ends
        return cls(motion, velocity, factor, step, np.asarray(values * np.exp(-line.eta * time)))

    def spectrum(self, s: ComplexArray) -> ComplexArray:
        """Return the transform of the weighted samples, a sudden start's kink corrected."""
        from scipy.fft import rfft

        plain = np.asarray(rfft(self.weighted))
        return plain + self.start_velocity * kink_spectrum(s, self.step) if self.start_velocity else plain


@dataclass(frozen=True, slots=True, eq=False)
class _Outputs:
    """Transfer functions that are known so far on the line."""

    stations: FloatArray
    direction: tuple[float, float]
    top: EndBody | None
    s: ComplexArray  #: (n,)
    strains: ComplexArray  #: (g, 2, n)
    end: ComplexArray  #: (2, n)

    @classmethod
    def empty(cls, stations: FloatArray, direction: tuple[float, float], top: EndBody | None) -> _Outputs:
        none = np.empty(0, dtype=np.complex128)
        return cls(stations, direction, top, none, none.reshape(stations.size, 2, 0), none.reshape(2, 0))

    def extended(self, cable: CoupledCable, s: ComplexArray) -> _Outputs:
        """Return the transfer functions on a longer line of the same spacing."""
        strains, end = strain_transfer(cable, s[self.s.size :], self.direction, self.stations, self.top)
        return _Outputs(
            self.stations,
            self.direction,
            self.top,
            s,
            np.concatenate([self.strains, strains], axis=2),
            np.concatenate([self.end, end], axis=1),
        )

    def fronts(self, cable: CoupledCable, line: TransformLine, drive: TransformDrive) -> FloatArray:
        """Return the strains (2, rows, g) of a sudden start on the straight cable; zero for a smooth one."""
        time = np.arange(line.rows) / line.rate
        if drive.start_velocity == 0.0:
            return np.zeros((2, 1, 1))
        check_sudden(cable, self.top, drive.start_velocity)
        return straight_strains(cable, drive.motion, self.direction, self.stations, time, drive.step)

    def response(
        self, cable: CoupledCable, line: TransformLine, drive: TransformDrive, fronts: FloatArray
    ) -> CoupledResponse:
        from scipy.fft import irfft

        count, damped = self.stations.size, cable.axial_damping_time > 0.0
        time = np.arange(line.rows) / line.rate
        strains = self.strains
        if drive.start_velocity:
            straight = replace(cable, curvature=0.0)
            strains = strains - strain_transfer(straight, self.s, self.direction, self.stations)[0]
        transfer = [strains.reshape(2 * count, -1), self.end]
        if damped:
            transfer.append(strains[:, 0] * self.s)
        series = irfft(np.concatenate(transfer) * drive.spectrum(self.s), drive.weighted.size)
        series = series[:, : (line.rows - 1) * drive.factor + 1 : drive.factor] * np.exp(line.eta * time)
        tangential, normal = fronts + series[: 2 * count].reshape(count, 2, -1).transpose(1, 2, 0)
        rates = series[2 * count + 2 :].T if damped else np.zeros_like(tangential)
        quadratic = tangential + 0.5 * (tangential**2 + normal**2)
        stretch = np.hypot(1.0 + tangential, normal)
        damping = (cable.axial_stiffness + cable.tension) * cable.axial_damping_time * rates
        return CoupledResponse(
            time=time,
            stations=self.stations,
            tangential_strain=tangential,
            normal_strain=normal,
            tension=(cable.tension + cable.axial_stiffness * quadratic) * stretch + damping,
            printed_tension=cable.axial_stiffness * quadratic,
            strain=cable.stretch * (stretch - 1.0),
            top_displacement=series[2 * count : 2 * count + 2].T,
        )
