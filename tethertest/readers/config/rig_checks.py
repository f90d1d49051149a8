"""What must hold between the keys of a rig or prototype file."""

from __future__ import annotations

import re
from collections.abc import Iterator
from itertools import combinations
from pathlib import Path, PureWindowsPath

from tethertest.errors import QuantityError
from tethertest.readers.config.cable_checks import cable_problems, weight_problems
from tethertest.readers.config.problems import NAME_SHOWN, Problem, is_file_name, suggestion
from tethertest.records.rig import Prototype, Rig, Sensor, sensor_noise, sensor_range

_GRATING = {"expected", "capture", "thermo_optic"}
_OPTIONAL_GRATING = {"thermo_optic_squared", "fibre"}
#: a load cell has these two, or a calibration
_SENSITIVITY = {"sensitivity", "rated"}
#: orders of polynomials that load cells are fitted with
_ORDERS = (1, 3)
#: kind of sensor -> keys it needs
NEEDED_KEYS = {
    "tension": {"at", "range"},
    "wavelength": {"at", "gauge_factor", "expansion"} | _GRATING,
    "temperature": set[str](),
    "displacement": {"at"},
}
#: kind of sensor -> keys it may have besides
ALLOWED_KEYS = {
    "tension": {"sensitivity", "rated", "calibration", "excitation"},
    "wavelength": {"range", "compensation", "temperature_change"} | _OPTIONAL_GRATING,
    "temperature": {"at", "range", "expansion"} | _GRATING | _OPTIONAL_GRATING,
    "displacement": {"range"},
}
_KIND_KEYS = sorted(set().union(*NEEDED_KEYS.values(), *ALLOWED_KEYS.values()))
_EXAMPLES = {
    "at": "0.5",
    "range": '["-10 N", "100 N"]',
    "sensitivity": '"2 mV/V"',
    "calibration": '{ log = "calibration.csv", order = 1 }',
    "rated": '"100 N"',
    "expected": '"1550 nm"',
    "capture": '"1.5 nm"',
    "gauge_factor": "0.78",
    "thermo_optic": '"6.5e-6 1/delta_degC"',
    "expansion": '"12e-6 1/delta_degC"',
    "compensation": '"temp1"',
}
_ORDER = re.compile(r"[1-9]\d*(/[1-9]\d*)?")


def rig_problems(rig: Rig) -> Iterator[Problem]:
    """Yield everything that is wrong between the keys of a rig."""
    yield from cable_problems(rig.cable, rig.air)
    yield from weight_problems(rig.cable, rig.platform, rig.gravity)
    yield from _duplicates("sensor", [sensor.name for sensor in rig.sensor])
    yield from _duplicates("instrument", [instrument.name for instrument in rig.instrument])
    for index, sensor in enumerate(rig.sensor):
        yield from _key_problems(index, sensor)
        yield from _text_problems(index, sensor)
        yield from _calibration_problems(index, sensor)
        yield from _compensation_problems(index, sensor, rig)
        if sensor.calibrated is not None and sensor.due is not None and sensor.due <= sensor.calibrated:
            yield Problem(
                ("sensor", index, "due"),
                f"found {sensor.due}, expected a day after the calibration of {sensor.calibrated}",
                "correct one of the two dates",
            )
    yield from _overlaps(rig)
    if rig.prototype is not None and (
        not rig.prototype or Path(rig.prototype).name != rig.prototype or not is_file_name(rig.prototype)
    ):
        text = f"found {rig.prototype[:NAME_SHOWN]!r}, expected the name of a prototype file"
        yield Problem(
            ("prototype",), text, 'write `prototype = "prototype-150m"` for the file beside the rig'
        )
    for table in ("order_amplitude", "order_phase"):
        for order in getattr(rig.limits, table):
            if not _ORDER.fullmatch(order):
                yield Problem(
                    ("limits", table, order),
                    f"found the order {order!r}, expected a multiple of the drive frequency",
                    'write whole or broken orders: "1", "2", "1/2"',
                )


def prototype_problems(prototype: Prototype) -> Iterator[Problem]:
    """Yield everything that is wrong between the keys of a prototype."""
    yield from cable_problems(prototype.cable, prototype.air)
    yield from weight_problems(prototype.cable, prototype.platform, prototype.gravity)
    for name, (low, high) in (("frequency", prototype.sea.frequency), ("amplitude", prototype.sea.amplitude)):
        if low > high:
            yield Problem(
                ("sea", name),
                f"found {low:g} before {high:g}, expected the smaller first",
                "swap the two values",
            )


def _duplicates(table: str, names: list[str]) -> Iterator[Problem]:
    for index, name in enumerate(names):
        if not name.strip():
            yield Problem((table, index, "name"), "found an empty name", f"name the {table}")
        elif name in names[:index]:
            text = f"found {name!r} a second time, expected every {table} to have its own name"
            yield Problem((table, index, "name"), text, "rename one of them")


def _key_problems(index: int, sensor: Sensor) -> Iterator[Problem]:
    needed = NEEDED_KEYS[sensor.kind]
    if sensor.kind == "tension" and sensor.calibration is None:
        needed = needed | _SENSITIVITY
    if sensor.kind == "temperature" and any(getattr(sensor, key) is not None for key in _GRATING):
        needed = needed | _GRATING
    for key in _KIND_KEYS:
        is_there = getattr(sensor, key) is not None
        if key in needed and not is_there:
            yield Problem(
                ("sensor", index, key),
                f"is missing; a {sensor.kind} sensor needs it",
                f"add `{key} = {_EXAMPLES[key]}` with the sensor's value",
            )
        elif is_there and key not in needed | ALLOWED_KEYS[sensor.kind]:
            yield Problem(
                ("sensor", index, key),
                f"does not belong to a {sensor.kind} sensor",
                f"remove {key}, or correct the kind",
            )


def _text_problems(index: int, sensor: Sensor) -> Iterator[Problem]:
    try:
        low, high = sensor_range(sensor)
    except QuantityError as error:
        yield Problem(("sensor", index, "range"), error.problem, error.remedy)
    else:
        if not low < high:
            text = f"found {list(sensor.range or ())}, expected the lower limit first"
            yield Problem(("sensor", index, "range"), text, "swap the two limits")
    try:
        noise = sensor_noise(sensor)
    except QuantityError as error:
        yield Problem(("sensor", index, "noise"), error.problem, error.remedy)
    else:
        if noise < 0.0:
            text = f"found {sensor.noise!r}, expected a standard deviation of at least 0"
            yield Problem(("sensor", index, "noise"), text, "correct the value")


def _calibration_problems(index: int, sensor: Sensor) -> Iterator[Problem]:
    calibration = sensor.calibration
    if calibration is None:
        return
    key = ("sensor", index, "calibration")
    if sensor.sensitivity is not None:
        text = "found a sensitivity and a calibration, expected one of them"
        yield Problem(("sensor", index, "sensitivity"), text, "remove the one that is not to be used")
    if (calibration.log is None) == (not calibration.points):
        found = "neither log nor points" if calibration.log is None else "both log and points"
        remedy = 'write { log = "calibration.csv", order = 1 }'
        yield Problem(key, f"found {found}, expected one of them", remedy)
    if calibration.points and len(calibration.points) < (calibration.order or 1) + 1:
        text = f"found {len(calibration.points)} pairs, expected at least {(calibration.order or 1) + 1}"
        yield Problem((*key, "points"), text, "add pairs of output and force")
    if calibration.order is not None and not _ORDERS[0] <= calibration.order <= _ORDERS[1]:
        text = f"found the order {calibration.order}, expected {_ORDERS[0]} to {_ORDERS[1]}"
        yield Problem((*key, "order"), text, "lower the order; a load cell is nearly a straight line")
    if calibration.units is not None and calibration.log is None:
        yield Problem((*key, "units"), "does not belong to points, which have their units", "remove units")
    if calibration.log is not None:
        windows = PureWindowsPath(calibration.log)
        if (
            not calibration.log.strip()
            or windows.drive
            or windows.root
            or ".." in windows.parts
            or not is_file_name(calibration.log)
        ):
            text = f"found {calibration.log[:NAME_SHOWN]!r}, expected a file beside the rig file"
            remedy = "copy the calibration log beside the rig file and give its name"
            yield Problem((*key, "log"), text, remedy)


def _compensation_problems(index: int, sensor: Sensor, rig: Rig) -> Iterator[Problem]:
    if sensor.compensation is None or sensor.kind != "wavelength":
        return
    other = rig.sensor_named(sensor.compensation)
    if other is None or other.kind != "temperature":
        found = "no sensor of the rig" if other is None else f"a {other.kind} sensor"
        thermometers = [entry.name for entry in rig.sensor if entry.kind == "temperature"]
        yield Problem(
            ("sensor", index, "compensation"),
            f"found {sensor.compensation!r}, which is {found}, expected a temperature sensor",
            suggestion(sensor.compensation, thermometers) if thermometers else "add a temperature sensor",
        )


def _overlaps(rig: Rig) -> Iterator[Problem]:
    """Yield gratings whose peaks could be taken for one another."""
    gratings = [
        (index, sensor.name, sensor.expected, sensor.capture)
        for index, sensor in enumerate(rig.sensor)
        if sensor.expected is not None and sensor.capture is not None
    ]
    for (_, one, at, reach), (index, other, other_at, other_reach) in combinations(gratings, 2):
        gap = abs(other_at - at)
        if gap < (reach + other_reach) * (1.0 - 1e-9):
            yield Problem(
                ("sensor", index, "capture"),
                f"the capture ranges of {one!r} and {other!r} overlap: {gap * 1e9:.4g} nm apart, with "
                f"{reach * 1e9:.4g} nm and {other_reach * 1e9:.4g} nm to each side",
                "lower capture until neighbouring gratings cannot be confused",
            )
