"""The rig: cable, platform, drive, instruments, sensors and acceptance limits."""

from __future__ import annotations

import datetime as dt
import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Annotated, Literal

from tethertest.records.cable import Air, Cable, Platform
from tethertest.records.calibration import Calibration, CalibrationData
from tethertest.records.quantity import SI
from tethertest.units import KINDS, parse_quantity

SensorKind = Literal["tension", "wavelength", "temperature", "displacement"]


@dataclass(frozen=True, slots=True)
class Instrument:
    """A logger with a clock of its own; a run's logs name it as their ``clock``."""

    name: str
    rate: Annotated[float, SI("Hz", above=0.0)]
    clock_drift: Annotated[float, SI("1", above=0.0, maximum=0.01)] = 1e-4  #: largest drift worth believing
    count: Annotated[float, SI("1", above=0.0)] | None = None  #: one count, as a ratio (V/V)


@dataclass(frozen=True, slots=True)
class Sensor:
    """One sensor; which keys it needs follows from its kind."""

    name: str
    kind: SensorKind
    at: Annotated[float, SI("1", minimum=0.0, maximum=1.0)] | None = (
        None  #: fraction of the length from the bottom
    )
    range: tuple[str, str] | None = None  #: text with units, in the unit of the kind
    #: load cell output at the rated load; bridges give a few mV/V
    sensitivity: Annotated[float, SI("1", above=0.0, maximum=0.1)] | None = None
    rated: Annotated[float, SI("N", above=0.0)] | None = None
    calibration: Calibration | None = None  #: pairs of output and force, in place of the sensitivity
    excitation: Annotated[float, SI("V", above=0.0)] | None = None  #: of the bridge, where a log has volts
    noise: str | None = None  #: standard deviation of one sample, text with unit
    calibrated: dt.date | None = None
    due: dt.date | None = None
    expected: Annotated[float, SI("m", above=0.0)] | None = None  #: grating's wavelength
    capture: Annotated[float, SI("m", above=0.0)] | None = None  #: largest believable distance from it
    gauge_factor: Annotated[float, SI("1", above=0.0)] | None = None
    thermo_optic: Annotated[float, SI("1/K")] | None = None  #: S1, at the temperature of rest
    thermo_optic_squared: Annotated[float, SI("1/K^2")] | None = None  #: S2
    expansion: Annotated[float, SI("1/K")] | None = None
    form: Literal["logarithmic", "linear"] = "logarithmic"  #: of wavelength against strain
    compensation: str | None = None  #: name of the temperature sensor
    #: without one: the temperature stays within this of its value at rest
    temperature_change: Annotated[float, SI("K", minimum=0.0, maximum=100.0)] | None = None
    fibre: int | None = None  #: interrogator channel; gratings of one fibre share its peaks


def sensor_range(sensor: Sensor) -> tuple[float, float]:
    """Return the measuring range in the SI unit of the sensor's kind; unbounded where the rig file has none.

    Raises
    ------
    QuantityError
        A limit is no quantity of the sensor's kind.
    """
    if sensor.range is None:
        return (-math.inf, math.inf)
    low, high = (parse_quantity(text, KINDS[sensor.kind]).value for text in sensor.range)
    return (low, high)


def sensor_noise(sensor: Sensor) -> float:
    """Return the standard deviation of one reading in SI; 0 where the rig file has none.

    A grating reads a wavelength [m], a temperature grating too; other sensors read the unit of their kind.

    Raises
    ------
    QuantityError
        The text is no quantity of what the sensor reads.
    """
    if sensor.noise is None:
        return 0.0
    unit = "m" if sensor.expected is not None else KINDS[sensor.kind]
    return parse_quantity(sensor.noise, unit).value


@dataclass(frozen=True, slots=True)
class RigDrive:
    """The crank-slider that moves the bottom end."""

    kind: Literal["crank-slider", "harmonic"] = "crank-slider"
    rod_ratio: Annotated[float, SI("1", minimum=0.0, maximum=0.99)] | None = None


@dataclass(frozen=True, slots=True)
class Limits:
    """Acceptance limits per metric: the largest relative error that still passes.

    At most 100 %: a bare 10 where 10 % was meant would let everything pass.
    """

    decision: Literal["guard", "simple"] = "guard"
    peak_tension: Annotated[float, SI("1", above=0.0, maximum=1.0)] | None = None
    order_amplitude: dict[str, Annotated[float, SI("1", above=0.0, maximum=1.0)]] = field(
        default_factory=dict
    )
    order_phase: dict[str, Annotated[float, SI("rad", above=0.0, maximum=math.pi)]] = field(
        default_factory=dict
    )
    sprague_geers: Annotated[float, SI("1", above=0.0, maximum=1.0)] | None = None


@dataclass(frozen=True, slots=True)
class Rig:
    """A rig file."""

    name: str
    cable: Cable
    platform: Platform
    sensor: tuple[Sensor, ...]
    instrument: tuple[Instrument, ...]
    limits: Limits
    air: Air | None = None
    drive: RigDrive = RigDrive()
    prototype: str | None = None
    gravity: Annotated[float, SI("m/s^2", above=0.0)] = 9.80665
    uncertainty: Mapping[str, float] = field(
        default_factory=dict
    )  #: "cable.length" -> standard uncertainty in SI
    calibrations: Mapping[str, CalibrationData] = field(
        default_factory=dict
    )  #: load cell -> its pairs, as read beside the rig file

    def sensor_named(self, name: str) -> Sensor | None:
        """Return the sensor of that name, if there is one."""
        return next((sensor for sensor in self.sensor if sensor.name == name), None)


@dataclass(frozen=True, slots=True)
class Sea:
    """What the prototype meets."""

    frequency: tuple[Annotated[float, SI("Hz", above=0.0)], Annotated[float, SI("Hz", above=0.0)]]
    amplitude: tuple[Annotated[float, SI("m", minimum=0.0)], Annotated[float, SI("m", minimum=0.0)]]


@dataclass(frozen=True, slots=True)
class Prototype:
    """A prototype file: the full-scale cable, platform and sea."""

    name: str
    cable: Cable
    platform: Platform
    sea: Sea
    air: Air | None = None
    gravity: Annotated[float, SI("m/s^2", above=0.0)] = 9.80665
    uncertainty: Mapping[str, float] = field(default_factory=dict)
