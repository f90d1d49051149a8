"""The rig: cable, platform, drive, instruments, sensors and acceptance limits."""

from __future__ import annotations

import datetime as dt
import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Annotated, Literal

from tethertest.records.cable import Air, Cable, Platform
from tethertest.records.calibration import Calibration, CalibrationData
from tethertest.records.described import NOT_IN_FILES, Doc
from tethertest.records.quantity import SI
from tethertest.units import KINDS, parse_quantity

SensorKind = Literal["tension", "wavelength", "temperature", "displacement"]
_Frequency = Annotated[float, SI("Hz", above=0.0)]
_Amplitude = Annotated[float, SI("m", minimum=0.0)]
ROD_RATIO = "radius of the crank over the length of its rod"
_SENSITIVITY = "load cell output at the rated load; bridges give a few mV/V"
_CHANGE = "without compensation: the temperature stays within this of its value at rest"
_DECISION = (
    "guard: an error passes or fails where its uncertainty leaves no doubt, else it is undecided; simple: "
    "the error alone decides"
)


@dataclass(frozen=True, slots=True)
class Instrument:
    """A logger with a clock of its own; a run's logs name it as their ``clock``."""

    name: Annotated[str, Doc("which the logs of a run name as their clock")]
    rate: Annotated[float, SI("Hz", "of the samples", above=0.0)]
    clock_drift: Annotated[float, SI("1", "largest drift worth believing", above=0.0, maximum=0.01)] = 1e-4
    count: Annotated[float, SI("1", "one count, as a ratio (V/V)", above=0.0)] | None = None


@dataclass(frozen=True, slots=True)
class Sensor:
    """One sensor; which keys it needs follows from its kind."""

    name: Annotated[str, Doc("of the sensor, as channels of logs are matched to it")]
    kind: Annotated[SensorKind, Doc("what it measures; a wavelength sensor is a grating that shows strain")]
    at: (
        Annotated[float, SI("1", "fraction of the length from the bottom", minimum=0.0, maximum=1.0)] | None
    ) = None
    range: Annotated[tuple[str, str], Doc("measuring range, text with the unit of the kind")] | None = None
    sensitivity: Annotated[float, SI("1", _SENSITIVITY, above=0.0, maximum=0.1)] | None = None
    rated: Annotated[float, SI("N", "load at which the sensitivity is stated", above=0.0)] | None = None
    calibration: Annotated[Calibration, Doc("in place of the sensitivity")] | None = None
    excitation: Annotated[float, SI("V", "of the bridge, where a log has volts", above=0.0)] | None = None
    noise: Annotated[str, Doc("standard deviation of one sample, text with unit")] | None = None
    calibrated: Annotated[dt.date, Doc("day of the calibration")] | None = None
    due: Annotated[dt.date, Doc("day from which the calibration has expired")] | None = None
    expected: Annotated[float, SI("m", "wavelength of the grating", above=0.0)] | None = None
    capture: Annotated[float, SI("m", "largest believable distance from expected", above=0.0)] | None = None
    gauge_factor: Annotated[float, SI("1", "relative change of wavelength per strain", above=0.0)] | None = (
        None
    )
    thermo_optic: Annotated[float, SI("1/K", "S1, at the temperature of rest")] | None = None
    thermo_optic_squared: (
        Annotated[float, SI("1/K^2", "S2, of the square of the temperature's change")] | None
    ) = None
    expansion: Annotated[float, SI("1/K", "thermal, of what the grating is bonded to")] | None = None
    form: Annotated[Literal["logarithmic", "linear"], Doc("of wavelength against strain")] = "logarithmic"
    compensation: Annotated[str, Doc("name of the temperature sensor")] | None = None
    temperature_change: Annotated[float, SI("K", _CHANGE, minimum=0.0, maximum=100.0)] | None = None
    fibre: Annotated[int, Doc("interrogator channel; gratings of one fibre share its peaks")] | None = None


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

    kind: Annotated[Literal["crank-slider", "harmonic"], Doc("what turns the crank's angle into motion")] = (
        "crank-slider"
    )
    rod_ratio: Annotated[float, SI("1", ROD_RATIO, minimum=0.0, maximum=0.99)] | None = None


@dataclass(frozen=True, slots=True)
class Limits:
    """Acceptance limits per metric: the largest relative error that still passes.

    At most 100 %: a bare 10 where 10 % was meant would let everything pass.
    """

    decision: Annotated[Literal["guard", "simple"], Doc(_DECISION)] = "guard"
    peak_tension: Annotated[float, SI("1", "of the largest tension", above=0.0, maximum=1.0)] | None = None
    order_amplitude: Annotated[
        dict[str, Annotated[float, SI("1", above=0.0, maximum=1.0)]],
        Doc('order of the drive, such as "1" or "1/2" -> limit of the error of its amplitude'),
    ] = field(default_factory=dict)
    order_phase: Annotated[
        dict[str, Annotated[float, SI("rad", above=0.0, maximum=math.pi)]],
        Doc('order of the drive, such as "1" or "1/2" -> limit of the error of its phase'),
    ] = field(default_factory=dict)
    sprague_geers: (
        Annotated[float, SI("1", "combined error of the whole series", above=0.0, maximum=1.0)] | None
    ) = None


@dataclass(frozen=True, slots=True)
class Rig:
    """A rig file."""

    name: Annotated[str, Doc("which reports show")]
    cable: Cable
    platform: Platform
    sensor: Annotated[tuple[Sensor, ...], Doc("[[sensor]] tables")]
    instrument: Annotated[tuple[Instrument, ...], Doc("[[instrument]] tables")]
    limits: Limits
    air: Air | None = None
    drive: RigDrive = RigDrive()
    prototype: Annotated[str, Doc("name of the prototype's file beside this one")] | None = None
    gravity: Annotated[float, SI("m/s^2", "where the rig stands", above=0.0)] = 9.80665
    #: "cable.length" -> standard uncertainty in SI
    uncertainty: Annotated[Mapping[str, float], NOT_IN_FILES] = field(default_factory=dict)
    #: load cell -> its pairs, as read beside the rig file
    calibrations: Annotated[Mapping[str, CalibrationData], NOT_IN_FILES] = field(default_factory=dict)

    def sensor_named(self, name: str) -> Sensor | None:
        """Return the sensor of that name, if there is one."""
        return next((sensor for sensor in self.sensor if sensor.name == name), None)


@dataclass(frozen=True, slots=True)
class Sea:
    """What the prototype meets."""

    frequency: Annotated[tuple[_Frequency, _Frequency], Doc("of the waves, lowest and highest")]
    amplitude: Annotated[tuple[_Amplitude, _Amplitude], Doc("of the bottom end, smallest and largest")]


@dataclass(frozen=True, slots=True)
class Prototype:
    """A prototype file: the full-scale cable, platform and sea."""

    name: Annotated[str, Doc("which reports show")]
    cable: Cable
    platform: Platform
    sea: Sea
    air: Air | None = None
    gravity: Annotated[float, SI("m/s^2", "where the prototype works", above=0.0)] = 9.80665
    uncertainty: Annotated[Mapping[str, float], NOT_IN_FILES] = field(default_factory=dict)
