"""A small rig and logs of it, made from a UAV bouncing on a massless cable: closed form, no solver."""

from __future__ import annotations

import datetime as dt
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np
import pytest

from tethertest.conditioning import RigPriors
from tethertest.records.cable import Cable, Platform, PlatformMode
from tethertest.records.channel import Channel, RawChannel, RawLog
from tethertest.records.rig import Instrument, Limits, Rig, Sensor
from tethertest.records.run import Drive, Log, Run, RunFile, Windows
from tethertest.replay.mechanics import tension_changes, tension_over_motion

DATE = dt.datetime(2026, 9, 5, 14, 20, tzinfo=dt.timezone(dt.timedelta(hours=8)))
MASS, STIFFNESS, CABLE = 0.4, 10_020.0, 3.0
HOVER, DAMPING, DAMPING_TIME = 50.0, 5.0, 5e-4
REST = {"tension_top": 5.0, "tension_bottom": 3.576}
WAVELENGTHS = {"fbg1": 1510.4662, "fbg2": 1534.4981, "temp1": 1569.9934}
PLACES = {"fbg1": 0.25, "fbg2": 0.75}
FREQUENCY, RADIUS = 0.5, 0.05
START, STOP, RAMP, END = 6.0, 28.0, 4.0, 42.0
TAPS = ((2.1, 5.5e-4), (3.7, 5e-4), (35.2, 5e-4), (37.6, 6e-4))
TAP_LENGTH = 0.06


def _grating(name: str) -> Sensor:
    strained = name in PLACES
    return Sensor(
        name,
        "wavelength" if strained else "temperature",
        at=PLACES.get(name),
        expected=round(WAVELENGTHS[name]) * 1e-9,
        capture=5.5e-9,
        gauge_factor=0.78 if strained else None,
        thermo_optic=6.5e-6,
        expansion=12e-6 if strained else None,
        compensation="temp1" if strained else None,
        noise="1 pm",
    )


def _cell(name: str, place: float) -> Sensor:
    return Sensor(
        name,
        "tension",
        at=place,
        range=("-10 N", "100 N"),
        sensitivity=2.0e-3,
        rated=100.0,
        noise="15 mN",
        calibrated=dt.date(2026, 3, 1),
        due=dt.date(2027, 3, 1),
    )


RIG = Rig(
    "bench",
    Cable(CABLE, "unstretched", 0.0484, STIFFNESS),
    Platform(MASS, 5.0, {"free": PlatformMode(HOVER, DAMPING)}),
    (
        _cell("tension_top", 1.0),
        _cell("tension_bottom", 0.0),
        Sensor("heave", "displacement", at=0.0, range=("-300 mm", "300 mm"), noise="0.01 mm"),
        *(_grating(name) for name in WAVELENGTHS),
    ),
    (Instrument("daq", 1000.0, count=2e-9), Instrument("interrogator", 100.0), Instrument("encoder", 200.0)),
    Limits(),
    uncertainty={
        "sensor.tension_top.sensitivity": 2e-6,
        "sensor.fbg1.gauge_factor": 0.004,
        "cable.axial_damping_time": 5e-5,
    },
)


def bottom_motion(time: np.ndarray, *, taps: bool = True, ramps: bool = True) -> np.ndarray:
    """Return the base's height [m]: taps at rest, crank ramped up and down over whole turns."""
    steady = STOP - START - RAMP
    if ramps:
        up, down = np.clip((time - START) / RAMP, 0, 1), np.clip((time - STOP) / RAMP, 0, 1)
        area = lambda r: r**4 * (2.5 - 3.0 * r + r**2)  # noqa: E731
        turned = RAMP * area(up) + np.clip(time - START - RAMP, 0, steady) + RAMP * (down - area(down))
    else:
        turned = time
    height = RADIUS * np.sin(2 * np.pi * FREQUENCY * turned)
    if taps:
        for start, lift in TAPS:
            height = height + lift * np.sin(np.pi * np.clip((time - start) / TAP_LENGTH, 0, 1)) ** 2
    return height


def answer(height: np.ndarray, step: float) -> np.ndarray:
    """Return the dynamic tension [N] of a mass with a position loop on a spring with a damper."""
    padded = 1 << (2 * height.size).bit_length()
    spectrum = np.fft.rfft(height, padded)
    omega = 2 * np.pi * np.fft.rfftfreq(padded, step)
    spring = STIFFNESS / CABLE * (1 + 1j * omega * DAMPING_TIME)
    end = HOVER - (MASS + 0.048) * omega**2 + 1j * omega * DAMPING
    return np.fft.irfft(-spring * end / (spring + end) * spectrum, padded)[: height.size]


def expected_tension(heave: Channel) -> Channel:
    """Return the bottom tension that a displacement asks for: what a pipeline would ask the solver."""
    step = 0.002
    time = np.arange(heave.time[0], heave.time[-1], step)
    height = np.interp(time, heave.time[heave.usable], heave.values[heave.usable])
    return Channel(
        "expected", "tension", "N", time, answer(height, step), np.zeros(time.size, np.uint16), at=0.0
    )


FILES = {"daq": "tension.lvm", "interrogator": "fbg.txt", "encoder": "crank.csv"}
NAMES = {"daq": ("F_top", "F_bottom"), "interrogator": tuple(WAVELENGTHS), "encoder": ("heave",)}


@dataclass
class Bench:
    """Logs of one run; a test spoils `columns` or `stamps` before it asks for the logs."""

    clocks: dict[str, tuple[float, float]]  #: clock -> offset [s] and drift against true time
    columns: dict[str, np.ndarray]
    stamps: dict[str, np.ndarray]
    starts: dict[str, dt.datetime]
    run: Run
    priors: RigPriors
    units: dict[str, str] = field(
        default_factory=lambda: {
            "F_top": "mV/V",
            "F_bottom": "mV/V",
            "heave": "mm",
            **dict.fromkeys(WAVELENGTHS, "nm"),
        }
    )

    def relative(self, clock: str) -> tuple[float, float]:
        """Return true offset and drift of a clock against the DAQ's."""
        offset, drift = self.clocks[clock]
        base, base_drift = self.clocks["daq"]
        ratio = (1 + drift) / (1 + base_drift)
        return offset - ratio * base, ratio - 1

    def logs(self) -> dict[str, RawLog]:
        result = {}
        for clock, file in FILES.items():
            time = self.stamps[clock]
            channels = tuple(
                RawChannel(name, self.units[name], time - time[0], self.columns[name])
                for name in NAMES[clock]
                if name in self.columns
            )
            start = self.starts.get(clock, DATE + dt.timedelta(seconds=float(time[0])))
            result[file] = RawLog(Path(file), "test", start.replace(tzinfo=None), channels, header_line=4)
        return result

    def with_file(self, **changes: object) -> Run:
        return replace(self.run, file=replace(self.run.file, **changes))


def make_bench(
    seed: int = 1,
    *,
    taps: bool = True,
    ramps: bool = True,
    drive: str = "crank-slider",
    shared: tuple[str, ...] = (),
) -> Bench:
    """Make a run; `shared` are instruments that run by the clock of the load cells."""
    random = np.random.default_rng(seed)
    step = 5e-4
    true = np.arange(-1.0, END + 1.0, step)
    height = bottom_motion(true, taps=taps, ramps=ramps) if drive != "none" else 0.0 * true
    dynamic = answer(height, step)
    signs = random.choice((-1.0, 1.0), 3)
    clocks = {
        name: (float(sign * random.uniform(0.3, 2.5)), float(random.uniform(-8e-5, 8e-5)))
        for name, sign in zip(("daq", "interrogator", "encoder"), signs, strict=True)
    }
    clocks |= dict.fromkeys(shared, clocks["daq"])
    columns: dict[str, np.ndarray] = {}
    stamps: dict[str, np.ndarray] = {}
    rates = {"daq": 500.0, "interrogator": 100.0, "encoder": 200.0}
    for clock, (offset, drift) in clocks.items():
        first = (1 + drift) * random.uniform(0.02, 0.3) + offset
        count = int((END - 0.4) * rates[clock])
        reading = first + np.arange(count) / rates[clock]
        stamps[clock] = reading
        time = (reading - offset) / (1 + drift)
        now = np.interp(time, true, dynamic)
        if clock == "daq":
            for name, sensor in (("F_top", "tension_top"), ("F_bottom", "tension_bottom")):
                drifted = REST[sensor] + now + 0.3 + 0.015 * time / END + random.normal(0, 0.015, count)
                columns[name] = np.round(drifted * 2.0 / 100.0, 6)
        elif clock == "encoder":
            noisy = np.interp(time, true, height) + random.normal(0, 1e-5, count) - 2.7e-4
            columns["heave"] = np.round(1e3 * noisy, 2)
        else:
            warming = 0.4 * np.sin(2 * np.pi * time / 200.0)
            for name, rest in WAVELENGTHS.items():
                strain = now / STIFFNESS if name in PLACES else 0.0
                change = 0.78 * (strain + 12e-6 * warming) if name in PLACES else 0.0
                value = rest * np.exp(change + 6.5e-6 * warming) + random.normal(0, 1e-3, count)
                columns[name] = np.round(value, 4)
    entries = (
        Log("tension.lvm", "daq", {"F_top": "tension_top", "F_bottom": "tension_bottom"}),
        Log("fbg.txt", "interrogator"),
        Log("crank.csv", "encoder"),
    )
    kind = "none" if drive == "none" else "crank-slider"
    frequency = None if drive == "none" else FREQUENCY
    file = RunFile("bench-1", "bench", DATE, Drive(kind, frequency, RADIUS), entries, windows=Windows())
    run = Run(Path("bench"), file, RIG, Path("bench.toml"))
    priors = RigPriors(REST, expected_tension, tension_changes(run), tension_over_motion(run))
    return Bench(clocks, columns, stamps, {}, run, priors)


@pytest.fixture
def bench() -> Bench:
    return make_bench()


@pytest.fixture
def maker() -> Callable[..., Bench]:
    return make_bench
