"""What the load cells, the gratings and the crank's encoder read, before it is written."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from .campaign import Plan
from .noise import Clock, generator, slow_drift
from .tether import Truth

Floats = NDArray[np.float64]

RATED = 100.0
SENSITIVITY = {"tension_top": 2.013, "tension_bottom": 1.987}
SENSITIVITY_SIGMA = 0.002
CELL_NOISE = 0.015
ZERO_DRIFT = 0.020
CLEAN_HUM = 0.002
MAINS = 50.0

EXPECTED = {"fbg1": 1510.0, "fbg2": 1522.0, "fbg3": 1534.0, "fbg4": 1546.0, "fbg5": 1558.0}
EXPECTED_TEMPERATURE = 1570.0
GAUGE_FACTOR = 0.78
GAUGE_FACTOR_SIGMA = 0.004
THERMO_OPTIC = 6.5e-6
EXPANSION = 12e-6
PICOMETRE = 1e-3
WARMING = 1.0

OPTICAL_RATE = 100
ENCODER_RATE = 200
ENCODER_STEP = 0.01


@dataclass
class Record:
    """Samples of one instrument, as its clock stamps them.

    Parameters
    ----------
    clock : Clock
        The instrument's clock.
    rate : float
        Samples per second by that clock.
    reading, true_time : ndarray
        What the clock shows, in s since the run's date, and the true time of every sample.
    channels : dict
        Values by channel, in the logger's unit.
    facts : dict
        What `truth.json` says of the instrument.
    """

    clock: Clock
    rate: float
    reading: Floats
    true_time: Floats
    channels: dict[str, Floats]
    facts: dict[str, object] = field(default_factory=dict)


def load_cells(plan: Plan, truth: Truth, clock: Clock) -> Record:
    """Return both load cells in mV/V."""
    reading, true_time = clock.samples(plan.tension_rate)
    progress = true_time / plan.duration
    channels: dict[str, Floats] = {}
    facts: dict[str, object] = {"noise_N": CELL_NOISE}
    for name in ("tension_top", "tension_bottom"):
        sensitivity = true_sensitivity(name)
        random = generator(plan.number, name)
        zero = random.uniform(0.1, 0.4) * random.choice((-1.0, 1.0)) * sensitivity / RATED
        drift = slow_drift(random, progress, ZERO_DRIFT)
        hum_size = random.uniform(0.3, 1.0) * CLEAN_HUM
        hum = hum_size * np.sin(2.0 * np.pi * MAINS * true_time + random.uniform(0.0, 6.28))
        noise = CELL_NOISE * random.standard_normal(true_time.size)
        force = np.interp(true_time, truth.time, getattr(truth, name))
        channels[name] = (force + drift + hum + noise) * sensitivity / RATED + zero
        facts[name] = {
            "sensitivity_mV_per_V": sensitivity,
            "zero_mV_per_V": zero,
            "zero_N": zero * RATED / sensitivity,
            "zero_drift_end_N": float(drift[-1]),
            "hum_N": hum_size,
        }
    return Record(clock, plan.tension_rate, reading, true_time, channels, facts)


def true_sensitivity(name: str) -> float:
    """Return the cell's true sensitivity, the same in every run."""
    deviation = float(generator(0, name).uniform(-1.0, 1.0)) * SENSITIVITY_SIGMA
    return round(SENSITIVITY[name] + deviation, 6)


def gratings(plan: Plan, truth: Truth, clock: Clock) -> Record:
    """Return the strain gratings and the free grating in nm."""
    reading, true_time = clock.samples(OPTICAL_RATE)
    random = generator(plan.number, "gratings")
    warming = slow_drift(random, true_time / plan.duration, WARMING)
    channels: dict[str, Floats] = {}
    facts: dict[str, object] = {
        "noise_pm": 1.0,
        "temperature_change_end_degC": float(warming[-1]),
        "temperature_reference": "the run's start",
        "thermo_optic_per_degC": THERMO_OPTIC,
        "expansion_per_degC": EXPANSION,
    }
    for row, (name, expected) in enumerate(EXPECTED.items()):
        fixed = generator(0, name)
        unstrained = round(expected + float(fixed.uniform(-0.04, 0.04)), 4)
        gauge_factor = round(GAUGE_FACTOR + float(fixed.uniform(-0.6, 0.6)) * GAUGE_FACTOR_SIGMA, 5)
        strain = np.interp(true_time, truth.time, truth.strain[row]) + EXPANSION * warming
        exponent = gauge_factor * strain + THERMO_OPTIC * warming
        noise = PICOMETRE * random.standard_normal(true_time.size)
        channels[name] = unstrained * np.exp(exponent) + noise
        facts[name] = {"unstrained_nm": unstrained, "gauge_factor": gauge_factor}
    free = round(EXPECTED_TEMPERATURE + float(generator(0, "temp1").uniform(-0.04, 0.04)), 4)
    noise = PICOMETRE * random.standard_normal(true_time.size)
    channels["temp1"] = free * np.exp(THERMO_OPTIC * warming) + noise
    facts["temp1"] = {"reference_nm": free}
    return Record(clock, OPTICAL_RATE, reading, true_time, channels, facts)


def encoder(plan: Plan, clock: Clock) -> Record:
    """Return the base's height in mm, in whole steps of the encoder."""
    reading, true_time = clock.samples(ENCODER_RATE)
    random = generator(plan.number, "encoder")
    origin = float(random.uniform(-0.5, 0.5))
    height = 1e3 * plan.motion(true_time) + origin
    noisy = height + ENCODER_STEP * random.standard_normal(true_time.size)
    steps = np.round(noisy / ENCODER_STEP) * ENCODER_STEP
    facts: dict[str, object] = {"noise_mm": ENCODER_STEP, "origin_mm": origin}
    return Record(clock, ENCODER_RATE, reading, true_time, {"heave": steps}, facts)
