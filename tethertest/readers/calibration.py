"""Calibrations of load cells: pairs of output and reference force, from a text file or a rig file."""

from __future__ import annotations

import math
import re
from dataclasses import replace
from pathlib import Path
from typing import Final

from tethertest.errors import FileFormatError, QuantityError, RunFileError, TethertestError
from tethertest.readers.fingerprint import file_sha256
from tethertest.readers.tables.text.document import read_document
from tethertest.records.calibration import CalibrationData, CalibrationPoint
from tethertest.records.rig import Rig, Sensor
from tethertest.units import Kind, UnitScale, channel_scale, parse_quantity

#: what a load cell's output may be
OUTPUT_KINDS: Final = ("ratio", "voltage", "count")
#: names of the two columns, and of the third that may follow
COLUMNS: Final = ("measured", "real")
UNCERTAINTY: Final = "uncertainty"
#: bytes of a calibration: some tens of rows, or some thousands
LARGEST: Final = 2**20
#: units of a reference given as a mass; [kg]
MASSES: Final = {"kg": 1.0, "g": 1e-3, "lb": 0.45359237, "lbs": 0.45359237}
#: a conventional mass is that of a weight of 8000 kg/m^3 in air of 1.2 kg/m^3 (OIML D 28)
BUOYANCY: Final = 1.0 - 1.2 / 8000.0
#: characters of a digest that are shown
DIGEST_SHOWN: Final = 12
_UNIT_IN_NAME = re.compile(r"^(?P<name>[^\[(]*?)\s*(?:[\[(](?P<unit>[^\])]*)[\])])?\s*$")
_NUMBER_AND_UNIT = re.compile(r"^\s*([-+]?[\d.]+(?:[eE][-+]?\d+)?)\s*(.*?)\s*$")
_COUNTS = {"adc", "adc counts", "raw", "lsb", "digits", "digit"}


def with_calibrations(rig: Rig, folder: Path) -> Rig:
    """Return the rig with the pairs of every load cell that has a calibration.

    Parameters
    ----------
    rig : Rig
        As its file has it.
    folder : Path
        Folder of the rig file, where calibration logs lie.

    Raises
    ------
    TethertestError
        A log is missing or wrong, or a pair of the rig file is no output and force.
    """
    found: dict[str, CalibrationData] = {}
    for sensor in rig.sensor:
        if sensor.calibration is None:
            continue
        if sensor.calibration.log is not None:
            path = folder / sensor.calibration.log
            found[sensor.name] = read_calibration(path, sensor.calibration.units, rig.gravity)
        else:
            found[sensor.name] = _written(sensor, rig.gravity)
    return replace(rig, calibrations=found) if found else rig


def read_calibration(path: Path, units: tuple[str, str] | None, gravity: float) -> CalibrationData:
    """Read a calibration log: a header ``measured [unit],real [unit]``, then a pair in each row.

    Parameters
    ----------
    path : Path
        Text with commas, semicolons or tabs; a third column ``uncertainty`` is the standard uncertainty of
        each force, in the unit of ``real``. Lines that begin with ``#`` are comments.
    units : tuple of str or None
        Units of output and force, for a header without them.
    gravity : float
        [m/s^2]; masses become ``m g (1 - 1.2/8000)`` newton, as conventional masses are defined.

    Raises
    ------
    FileFormatError
        File, line, what was found and what was expected.
    """
    if path.is_file() and path.stat().st_size > LARGEST:
        message = f"found {path.stat().st_size} bytes, expected a calibration of at most {LARGEST}"
        raise FileFormatError(message, "name the calibration, not the log of it", path=path)
    lines = read_document(path).body.decode().split("\n")
    rows = [(number, line) for number, line in enumerate(lines, 1) if line.strip() and line.strip()[0] != "#"]
    if not rows:
        message = "found no row, expected a header 'measured,real' and pairs"
        raise FileFormatError(message, "export the calibration again", path=path)
    header_line, header = rows[0]
    separator = next((sign for sign in "\t;," if sign in header), None)
    cells = [] if separator is None else [cell.strip().strip('"') for cell in header.split(separator)]
    named = [match for cell in cells if (match := _UNIT_IN_NAME.match(cell))]
    names = tuple(match["name"].lower() for match in named)
    if separator is None or names not in {COLUMNS, (*COLUMNS, UNCERTAINTY)}:
        message = f"found the header {header.strip()[:80]!r}, expected 'measured [mV/V],real [N]'"
        remedy = "name the columns measured and real, and a third one uncertainty if there is one"
        raise FileFormatError(message, remedy, path=path, line=header_line)
    written = [match["unit"] or "" for match in named]
    for number, unit in enumerate(units or ()):
        if written[number] and written[number] != unit:
            message = f"the header has the unit {written[number]!r} and the rig file {unit!r}"
            raise FileFormatError(message, "remove one of the two", path=path, line=header_line)
        written[number] = unit
    if len(written) > 2 and written[2] not in {"", written[1]}:
        message = f"found uncertainties in {written[2]!r}, expected the unit of real, {written[1]!r}"
        raise FileFormatError(message, "convert them", path=path, line=header_line)
    try:
        output, force = _output_scale(written[0]), _force_scale(written[1], gravity)
    except QuantityError as error:
        raise FileFormatError(error.problem, error.remedy, path=path, line=header_line) from None
    points = tuple(
        _point(path, number, line.split(separator), len(cells), output, force) for number, line in rows[1:]
    )
    return CalibrationData(output.kind, points, f"{path.name} (sha256 {file_sha256(path)[:DIGEST_SHOWN]}...)")


def _point(
    path: Path, number: int, cells: list[str], width: int, output: UnitScale, force: UnitScale
) -> CalibrationPoint:
    if len(cells) != width:
        message = f"found {len(cells)} cells, expected {width} as in the header"
        remedy = "a comma as decimal sign needs ; or tabs between the columns" if len(cells) > width else ""
        raise FileFormatError(message, remedy or "complete the row", path=path, line=number)
    values: list[float] = []
    for cell in cells:
        text = cell.strip().strip('"')
        try:
            value = float(text)
        except ValueError:
            value = math.nan
        if not math.isfinite(value):
            comma = "write decimals with a point" if re.fullmatch(r"[-+]?\d+,\d+", text) else ""
            message = f"found {text!r}, expected a number"
            raise FileFormatError(message, comma or "correct or remove the row", path=path, line=number)
        values.append(value)
    spread = abs(force.factor) * values[2] if width > 2 else None
    if spread is not None and not spread > 0.0:
        message = f"found the uncertainty {values[2]:g}, expected more than 0"
        raise FileFormatError(message, "state it, or remove the column", path=path, line=number)
    return CalibrationPoint(output.factor * values[0], force.factor * values[1], spread, f"line {number}")


def _output_scale(unit: str) -> UnitScale:
    if unit.strip().lower() in _COUNTS:
        return channel_scale("count", "count")
    scale = channel_scale(unit)
    if scale.kind not in OUTPUT_KINDS:
        found = f"the unit {unit!r}" if unit else "no unit"
        message = f"measured has {found}, expected mV/V, V or counts"
        raise QuantityError(message, 'write it in the header, or units = ["mV/V", "N"] in the rig file')
    return scale


def _force_scale(unit: str, gravity: float) -> UnitScale:
    mass = MASSES.get(unit.strip().lower())
    if mass is not None:
        return UnitScale(Kind.TENSION, "N", mass * gravity * BUOYANCY)
    if not unit.strip():
        message = "real has no unit, expected N or kg"
        raise QuantityError(message, 'write it in the header, or units = ["mV/V", "N"] in the rig file')
    return channel_scale(unit, "tension")


def _written(sensor: Sensor, gravity: float) -> CalibrationData:
    """Return the pairs of the rig file itself."""
    kinds: set[str] = set()
    points: list[CalibrationPoint] = []
    for number, (output, force) in enumerate(sensor.calibration.points if sensor.calibration else (), 1):
        try:
            kind, measured = _output(output)
            kinds.add(kind)
            points.append(CalibrationPoint(measured, *_force(force, gravity), f"point {number}"))
        except TethertestError as error:
            message = f"sensor.{sensor.name}.calibration.points, pair {number}: {error.problem}"
            raise RunFileError(message, error.remedy) from None
    if len(kinds) != 1:
        message = f"sensor.{sensor.name}.calibration.points has outputs of kinds {', '.join(sorted(kinds))}"
        raise RunFileError(message, "give all outputs in one unit")
    return CalibrationData(kinds.pop(), tuple(points), "rig file")


def _output(text: str) -> tuple[str, float]:
    match = _NUMBER_AND_UNIT.match(text)
    if match is None:
        message = f"found {text!r}, expected an output such as 2 mV/V"
        raise QuantityError(message, "write a number and its unit")
    scale = _output_scale(match[2])
    return scale.kind, scale.factor * parse_quantity(match[1], "1").value


def _force(text: str, gravity: float) -> tuple[float, float | None]:
    try:
        found = parse_quantity(text, "N")
        factor = 1.0
    except QuantityError as error:
        try:
            found = parse_quantity(text, "kg")
        except QuantityError:
            raise error from None
        factor = gravity * BUOYANCY
    spread = None if found.uncertainty is None else factor * found.uncertainty
    return factor * found.value, spread
