"""Waves up and down the cable: tension and velocity at a section, or tensions at several places.

A wave going up, ``f(t - s/c)``, has ``F = -Z v``; one going down has ``F = Z v``, with the impedance
``Z = sqrt(EA m)`` and s, v upwards, in the material coordinate. So the two parts of the dynamic tension at a
section are ``(F - Z v)/2`` and ``(F + Z v)/2``, for any motion and for each order of the drive.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np
import numpy.typing as npt

from tethertest.errors import DataError
from tethertest.records.arrays import FloatArray
from tethertest.records.lines import ChannelLines, Line
from tethertest.records.waves import OrderWaves

ComplexArray = npt.NDArray[np.complex128]

#: a line of at least this many standard errors has waves worth separating
CLEAR: Final = 2.8
#: relative standard uncertainty of the stronger wave above which nothing is said
LARGEST_UNCERTAINTY: Final = 0.3
#: neglected curvature, drag and sensor compliance shift the tensions along a taut cable by this share
MODEL_SHARE: Final = 1e-3
#: draws of the error propagation, and their seed: the same input gives the same interval
DRAWS, SEED = 4000, 20221110
#: a weaker wave below this share of the stronger one is round-off
NOTHING: Final = 1e-12


@dataclass(frozen=True, slots=True)
class Medium:
    """The cable that carries axial waves, in the material coordinate."""

    impedance: float  #: sqrt(EA m) [N s/m]
    speed: float  #: sqrt(EA/m) [m/s]
    length: float  #: unstretched [m]
    impedance_error: float = 0.0  #: standard uncertainty, relative
    speed_error: float = 0.0  #: standard uncertainty, relative


@dataclass(frozen=True, slots=True)
class Station:
    """The lines of one sensor at its place."""

    at: float  #: fraction of the length from the bottom
    lines: ChannelLines  #: of tension, or of strain
    factor: float = 1.0  #: from the channel's unit to N: EA for strain
    scale_error: float = 0.0  #: standard uncertainty of the scale, relative
    time_error: float = 0.0  #: standard uncertainty of the clock [s]


def up_and_down(tension: FloatArray, velocity: FloatArray, impedance: float) -> tuple[FloatArray, FloatArray]:
    """Return the tension of the wave going up and of the one going down.

    Parameters
    ----------
    tension : (n,) float64
        Dynamic tension at a section [N]: the tension at rest taken off.
    velocity : (n,) float64
        Velocity along the cable there, upwards [m/s].
    impedance : float
        ``sqrt(EA m)`` [N s/m].

    Returns
    -------
    tuple of (n,) float64
        Up, down [N]; their sum is the dynamic tension.
    """
    part = impedance * velocity
    return 0.5 * (tension - part), 0.5 * (tension + part)


def section_waves(tension: Station, motion: Station, medium: Medium) -> tuple[OrderWaves, ...]:
    """Separate the waves of every clear order from tension and motion at one section.

    Parameters
    ----------
    tension : Station
        Lines of the tension.
    motion : Station
        Lines of the velocity [m/s] or of the displacement [m] at the same place, upwards.
    medium : Medium
        The cable.

    Raises
    ------
    DataError
        The two are not at the same place, or the motion has another unit.
    """
    if tension.at != motion.at:
        message = f"{tension.lines.channel!r} and {motion.lines.channel!r} are not at the same place"
        raise DataError(message, "take tension and motion at one section")
    if motion.lines.unit not in {"m", "m/s"}:
        message = f"channel {motion.lines.channel!r} is in {motion.lines.unit!r}, expected m or m/s"
        raise DataError(message, "take a displacement or a velocity along the cable")
    random = np.random.default_rng(SEED)
    found = []
    for line in _clear(tension.lines):
        moved = motion.lines.line(line.order)
        if moved is None:
            continue
        pace = 2j * np.pi * line.frequency if motion.lines.unit == "m" else 1.0
        force = _draws(tension, line, random)
        velocity = pace * _draws(motion, moved, random)
        share = medium.impedance * (1.0 + medium.impedance_error * _normal(random)) * velocity
        found.append(_order(line, 0.5 * (force - share), 0.5 * (force + share), medium, ""))
    return tuple(found)


def separated_waves(stations: Sequence[Station], medium: Medium) -> tuple[OrderWaves, ...]:
    """Separate the waves of every order from tensions at two places or more, with the wave speed known.

    Weighted least squares of ``U exp(-i k s) + D exp(i k s)`` per order; phases refer to the lowest station.
    With two sensors a distance d apart errors grow by ``1/|sin k d|``: towards zero spacing and towards
    whole multiples of half a wave length nothing can be told, and the order is refused.

    Parameters
    ----------
    stations : sequence of Station
        Tension or strain at different places.
    medium : Medium
        The cable.

    Raises
    ------
    DataError
        Fewer than two places.
    """
    ordered = sorted(stations, key=lambda station: station.at)
    if len({station.at for station in ordered}) < 2:
        message = "waves need tensions at two places of the cable or more"
        raise DataError(message, "add a load cell or a strain grating at another place")
    place = np.array([station.at - ordered[0].at for station in ordered]) * medium.length
    random = np.random.default_rng(SEED)
    found = []
    for line in _clear(ordered[0].lines):
        lines = [station.lines.line(line.order) for station in ordered]
        known = [index for index, item in enumerate(lines) if item is not None]
        if len({ordered[index].at for index in known}) < 2:
            continue
        present = [(ordered[index], item) for index, item in enumerate(lines) if item is not None]
        force = np.stack([_draws(station, item, random) for station, item in present])
        force[:, 1:] *= 1.0 + MODEL_SHARE * random.standard_normal((len(present), DRAWS))
        speed = medium.speed * (1.0 + medium.speed_error * _normal(random))
        phase = 2.0 * np.pi * line.frequency / speed * place[known][:, None]
        spread = np.array([_spread(station, item) for station, item in present])
        up, down = _solved(phase, force, spread)
        found.append(_order(line, up, down, medium, _amplified(float(phase[-1, 0]))))
    return tuple(found)


def _clear(lines: ChannelLines) -> list[Line]:
    return [line for line in lines.lines if line.amplitude > CLEAR * line.standard_error]


def _normal(random: np.random.Generator) -> FloatArray:
    """Return normal deviates (draws + 1,), the first zero: the estimate itself."""
    return np.concatenate([[0.0], random.standard_normal(DRAWS)])


def _draws(station: Station, line: Line, random: np.random.Generator) -> ComplexArray:
    """Return the complex amplitude (draws + 1,) in N, m or m/s; the first is the estimate."""
    noise = line.standard_error * (_normal(random) + 1j * _normal(random))
    late = np.exp(2j * np.pi * line.frequency * station.time_error * _normal(random))
    amplitude = line.amplitude * np.exp(1j * line.phase) + noise
    drawn: ComplexArray = station.factor * amplitude * late * (1.0 + station.scale_error * _normal(random))
    return drawn


def _spread(station: Station, line: Line) -> float:
    """Return the standard uncertainty [N] of a station's amplitude, for its weight."""
    turn = 2.0 * np.pi * line.frequency * station.time_error
    share = line.amplitude * float(np.linalg.norm([station.scale_error, MODEL_SHARE, turn]))
    return station.factor * float(np.hypot(line.standard_error, share))


def _solved(phase: FloatArray, force: ComplexArray, spread: FloatArray) -> tuple[ComplexArray, ComplexArray]:
    """Return both waves (draws + 1,) by weighted least squares in closed form."""
    weight = (1.0 / np.maximum(spread, NOTHING * float(np.max(np.abs(force[:, 0])))) ** 2)[:, None]
    rising = np.exp(-1j * phase)
    total = np.sum(weight) * np.ones(phase.shape[1])
    cross = np.sum(weight * rising.conj() ** 2, axis=0)
    first = np.sum(weight * rising.conj() * force, axis=0)
    second = np.sum(weight * rising * force, axis=0)
    determinant = np.maximum(total**2 - np.abs(cross) ** 2, NOTHING * total**2)
    up = (total * first - cross * second) / determinant
    down = (total * second - cross.conj() * first) / determinant
    return up, down


def _amplified(turn: float) -> str:
    share = abs(np.sin(turn))
    growth = f"{1.0 / share:.3g}" if share > NOTHING else "without bound"
    return f"the sensors span {turn / (2.0 * np.pi):.3g} of a wave length, so errors grow {growth} times"


def _order(line: Line, up: ComplexArray, down: ComplexArray, medium: Medium, spacing: str) -> OrderWaves:
    above, below = np.abs(up), np.abs(down)
    strong, weak = np.maximum(above, below), np.minimum(above, below)
    ratio = np.divide(weak**2, strong**2, out=np.ones_like(weak), where=strong > 0.0)
    power = (above**2 - below**2) / (2.0 * medium.impedance)
    uncertainty = float(np.std(strong[1:])) / max(float(strong[0]), 1e-300)
    refused = ""
    if not uncertainty <= LARGEST_UNCERTAINTY:
        refused = f"not separable: the stronger wave is known to {uncertainty:.0%} only"
        refused += f"; {spacing}" if spacing else ""
    gap = float(strong[0] - weak[0])
    standing = float(strong[0] + weak[0]) / gap if gap > NOTHING * strong[0] else float("inf")
    return OrderWaves(
        order=line.order,
        frequency=line.frequency,
        up=float(above[0]),
        up_interval=_interval(above),
        down=float(below[0]),
        down_interval=_interval(below),
        energy_ratio=float(ratio[0]),
        energy_ratio_interval=_interval(ratio),
        standing_wave_ratio=standing,
        power=float(power[0]),
        power_interval=_interval(power),
        refused=refused,
    )


def _interval(draws: FloatArray) -> tuple[float, float]:
    low, high = np.quantile(draws[1:], (0.025, 0.975))
    return float(min(low, draws[0])), float(max(high, draws[0]))
