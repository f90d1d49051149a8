"""Random runs with known clocks: two instruments that saw the same motion, each by its own stamps."""

from __future__ import annotations

import datetime as dt
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Literal

import numpy as np
from scipy.interpolate import CubicSpline

from reports.clock_errors.bar import standard_uncertainties, tension_changes
from reports.clock_errors.bound import Bound, Waveform, bound
from reports.clock_errors.motion import SHARES, TAP_LENGTH, Transients, drawn_motion
from reports.clock_errors.rig import (
    BELIEVABLE_DRIFT,
    GAUGE_FACTOR,
    PLACES,
    RIG,
    Expected,
    answered,
    drawn_bar,
    stated_bar,
)
from reports.clock_errors.sampling import STAMPS, Sampling, between
from tethertest.conditioning.rig_priors import RigPriors
from tethertest.records.arrays import FloatArray
from tethertest.records.channel import Channel
from tethertest.records.rig import Rig
from tethertest.records.run import Drive, Log, Run, RunFile, RunPlatform
from tethertest.units import Kind as ChannelKind

Kind = Literal["strain", "motion"]

SEED = 20261125
#: step of the true signals [s], and every how many of them the bound looks: the UAV bounces at 14 Hz, a knock
#: has little above 40 Hz
STEP, BOUND_EVERY = 1e-3, 4
#: a drive that runs when the record begins has run for this long: a UAV that holds no height bounces on for
#: 3 s after it was set in motion [s]
LEAD = 15.0
#: share of the runs that compare strain with tension; the others compare the motion with it
STRAIN_SHARE = 0.6
#: noise of one sample [N, m, m]; drawn between a third and three times these
CELL_NOISE, GRATING_NOISE, ENCODER_NOISE = 0.015, 1e-12, 1e-5
SPREAD = 3.0
#: relative standard error of the gain between strain and tension
GAIN = 0.01
#: wavelength of the gratings [m], and warming over the record [K] with its effect on ln(wavelength) [1/K]
WAVELENGTH, WARMING, THERMAL = 1534e-9, 1.0, 6.5e-6 + GAUGE_FACTOR * 12e-6
#: drift of a load cell's zero over the record [N] and its hum [N] at 50 Hz
ZERO_DRIFT, HUM, MAINS = 0.02, 0.002, 50.0
#: rest tension [N]
REST = 5.0
DATE = dt.datetime(2026, 9, 5, 14, 20, tzinfo=dt.UTC)


@dataclass(frozen=True, slots=True, eq=False)
class SyntheticRun:
    """One run: what the alignment is given, and what it was made with."""

    number: int
    kind: Kind
    transients: Transients
    stamps: str
    gaps: int
    length: float  #: [s]
    frequency: float  #: [Hz]
    rates: tuple[float, float]  #: of the reference and of the clock [Hz]
    clock: str
    channels: tuple[Channel, ...]
    reference: tuple[Channel, ...]
    run: Run
    priors: RigPriors
    offset: float  #: true, of the audited stamps [s]
    drift: float  #: true [1]
    bound: Bound


def random_run(number: int, rig: Rig = RIG) -> SyntheticRun:
    """Return the run of a number; the same number is the same run.

    Parameters
    ----------
    number : int
    rig : Rig
        `RIG`, from which the true rig differs by as much as it states, or `KNOWN_RIG`.
    """
    random = np.random.default_rng([SEED, number])
    kind: Kind = "strain" if random.random() < STRAIN_SHARE else "motion"
    transients: Transients = random.choice(np.array(list(SHARES)), p=list(SHARES.values())).item()
    length = float(random.uniform(30.0, 300.0))
    mode = str(random.choice(["hold", "soft", "free"], p=[0.4, 0.4, 0.2]))
    # a UAV that holds no height hardly pulls below its 0.7 Hz
    slowest = 0.7 if mode == "free" else 0.1
    frequency = float(np.exp(random.uniform(np.log(slowest), np.log(2.0))))
    motion = drawn_motion(random, transients, frequency, length)
    fastest, slowest_rate = np.log(2000.0), np.log(20.0)
    first, second = np.exp(random.uniform(slowest_rate, fastest, 2))
    rates = (float(first), float(second))
    stamps = str(random.choice(list(STAMPS), p=list(STAMPS.values())))
    clock = "interrogator" if kind == "strain" else "encoder"

    lead = np.arange(-LEAD, length + 1.0, STEP)
    run_in = lead.size - np.count_nonzero(lead >= -1.0)
    time, height = lead[run_in:], motion(lead)
    bar = drawn_bar(random, mode, rig)
    size = np.exp(random.uniform(-np.log(SPREAD), np.log(SPREAD), 2))
    drift = random.uniform(-BELIEVABLE_DRIFT, BELIEVABLE_DRIFT)
    offset = random.uniform(-5.0, 5.0)
    stamped = int(random.random() < 0.5)
    samplings = [
        Sampling(random, rate, length, clocked, stamps if index == stamped else "exact")
        for index, (rate, clocked) in enumerate(zip(rates, ((0.0, 0.0), (offset, drift)), strict=True))
    ]
    bottom, top = (answered(height, STEP, bar, place)[run_in:] for place in (0.0, 1.0))
    height = height[run_in:]
    reference = _cells(random, samplings[0], time, (bottom, top), CELL_NOISE * size[0])
    thin = slice(None, None, BOUND_EVERY)
    if kind == "strain":
        channels = _gratings(
            random, samplings[1], time + bar.axial_damping_time, (bottom, top), GRATING_NOISE * size[1]
        )
        noise = bar.axial_stiffness / GAUGE_FACTOR / WAVELENGTH * GRATING_NOISE * size[1]
        noises = (CELL_NOISE * size[0] / np.sqrt(2.0), noise / np.sqrt(len(PLACES)))
        lag = rig.uncertainty["cable.axial_damping_time"]
        wave = Waveform(time[thin], 0.5 * (bottom + top)[thin], noises, rates, None, (), lag)
    else:
        encoder = samplings[1]
        heave = CubicSpline(time, height)(encoder.true)
        heave = heave + ENCODER_NOISE * size[1] * random.standard_normal(heave.size)
        channels = (encoder.channel("heave", ChannelKind.DISPLACEMENT, "m", heave, 0.0),)
        noises = (CELL_NOISE * size[0], ENCODER_NOISE * size[1])
        stated = stated_bar(mode)
        uncertain = standard_uncertainties(rig, mode, stated)
        changes = tension_changes(stated, uncertain, height[thin], BOUND_EVERY * STEP)
        wave = Waveform(time[thin], bottom[thin], noises, rates, bar, changes, 0.0)
    true_offset, true_drift = between(samplings[0], samplings[1])
    only = tuple((when - 0.1, when + TAP_LENGTH + 0.2) for when, _ in motion.taps) if kind == "motion" else ()
    return SyntheticRun(
        number, kind, transients, stamps, sum(item.gaps for item in samplings), length, frequency, rates,
        clock, channels, reference, _run(clock, frequency, motion.radius, mode, transients, rig),
        RigPriors(
            {},
            Expected(mode),
            partial(tension_changes, stated_bar(mode), standard_uncertainties(rig, mode, stated_bar(mode))),
            drive_frequency=None if transients == "knocks alone" else frequency,
        ),
        true_offset, true_drift,
        bound(wave, samplings[0].seen, samplings[1].seen, only, BELIEVABLE_DRIFT / np.sqrt(3.0)),
    )  # fmt: skip


def _cells(
    random: np.random.Generator,
    sampling: Sampling,
    time: FloatArray,
    ends: tuple[FloatArray, FloatArray],
    noise: float,
) -> tuple[Channel, ...]:
    """Return the tension at the bottom and at the top."""
    cells = []
    for name, place, tension in (("tension_bottom", 0.0, ends[0]), ("tension_top", 1.0, ends[1])):
        zero = random.uniform(-ZERO_DRIFT, ZERO_DRIFT) * sampling.true / time[-1]
        hum = HUM * np.sin(2.0 * np.pi * (MAINS * sampling.true + random.uniform()))
        values = REST + CubicSpline(time, tension)(sampling.true) + zero + hum
        values = values + noise * random.standard_normal(values.size)
        cells.append(sampling.channel(name, ChannelKind.TENSION, "N", values, place))
    return tuple(cells)


def _gratings(
    random: np.random.Generator,
    sampling: Sampling,
    time: FloatArray,
    ends: tuple[FloatArray, FloatArray],
    noise: float,
) -> tuple[Channel, ...]:
    """Return wavelengths; below 20 Hz the tension is linear along the cable to a thousandth."""
    stiffness = RIG.cable.axial_stiffness or 1.0
    warming = WARMING * random.uniform(-1.0, 1.0) * np.sin(2.0 * sampling.true / time[-1])
    gain = 1.0 + GAIN * random.standard_normal()
    bottom, top = (CubicSpline(time, end)(sampling.true) for end in ends)
    gratings = []
    for number, place in enumerate(PLACES, 1):
        strain = gain * ((1.0 - place) * bottom + place * top) / stiffness
        values = WAVELENGTH * np.exp(GAUGE_FACTOR * strain + THERMAL * warming)
        values = values + noise * random.standard_normal(values.size)
        gratings.append(sampling.channel(f"fbg{number}", ChannelKind.WAVELENGTH, "m", values, place))
    return tuple(gratings)


def _run(clock: str, frequency: float, radius: float, mode: str, transients: Transients, rig: Rig) -> Run:
    drive = Drive("none") if transients == "knocks alone" else Drive("crank-slider", frequency, radius)
    logs = (Log("tension.lvm", "daq"), Log("other.txt", clock))
    file = RunFile("study", "study", DATE, drive, logs, RunPlatform(mode))
    return Run(Path("study"), file, rig, Path("study.toml"))
