"""Calibration logs are read right or refused with the line and a remedy."""

from __future__ import annotations

import pytest

from tethertest.errors import TethertestError
from tethertest.readers.calibration import read_calibration
from tethertest.readers.config.load import load_rig

GRAVITY = 9.80665


def written(tmp_path, text):
    path = tmp_path / "c.csv"
    path.write_bytes(text.encode() if isinstance(text, str) else text)
    return path


@pytest.mark.parametrize(
    "text",
    [
        "measured [mV/V],real [N]\n0.1,0\n2.1,100\n",
        "\ufeffMeasured (mV/V);Real (N)\r\n0.1;0\r\n2.1;100\r\n",
        "# cell 7\nmeasured [V/V]\treal [kN]\n0.0001\t0\n\n0.0021\t0.1\n",
    ],
)
def test_layouts(tmp_path, text):
    data = read_calibration(written(tmp_path, text), None, GRAVITY)
    assert data.kind == "ratio"
    assert [point.measured for point in data.points] == pytest.approx([1e-4, 2.1e-3])
    assert [point.force for point in data.points] == pytest.approx([0.0, 100.0])
    assert data.points[0].uncertainty is None
    assert "c.csv" in data.source


def test_weights_in_kilogram_pull_with_local_gravity_in_air(tmp_path):
    path = written(tmp_path, "measured [counts],real [kg],uncertainty\n10,1,0.001\n20,2,0.001\n")
    point = read_calibration(path, None, 9.79).points[1]
    assert point.force == pytest.approx(2 * 9.79 * (1 - 1.2 / 8000), rel=1e-12)
    assert point.uncertainty == pytest.approx(0.001 * 9.79, rel=1e-3)
    assert point.place == "line 3"


def test_units_from_the_rig_file(tmp_path):
    path = written(tmp_path, "measured,real\n312660.55,200.17\n569729.3,1000.85\n")
    assert read_calibration(path, ("count", "N"), GRAVITY).kind == "count"
    with pytest.raises(TethertestError, match=r"c\.csv:1: measured has no unit"):
        read_calibration(path, None, GRAVITY)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("", "c.csv"),
        ("time,force\n1,2\n", "c.csv:1: found the header 'time,force'"),
        ("measured [mV/V],real [N]\n0,1,0\n", "c.csv:2: found 3 cells, expected 2"),
        ("measured [mV/V];real [N]\n0;1\n0,5;10\n", "c.csv:3: found '0,5', expected a number"),
        ("measured [mV/V],real [N]\n0,\n", "c.csv:2: found ''"),
        ("measured [mV/V],real [N]\nnan,1\n", "c.csv:2: found 'nan'"),
        ("measured [mm],real [N]\n0,1\n", "c.csv:1: measured has the unit 'mm'"),
        ("measured [mV/V],real [mm]\n0,1\n", "c.csv:1: .*dimension"),
        ("measured [mV/V],real\n0,1\n", "c.csv:1: real has no unit"),
        ("measured [mV/V],real [N],uncertainty\n0,1,0\n", "c.csv:2: found the uncertainty 0"),
        ("measured [mV/V],real [kN],uncertainty [N]\n0,1,0.1\n", "c.csv:1: found uncertainties in 'N'"),
    ],
)
def test_refused_with_the_line(tmp_path, text, words):
    with pytest.raises(TethertestError, match=words):
        read_calibration(written(tmp_path, text), None, GRAVITY)


RIG = """\
name = "bench"
[cable]
length = "3 m"
length_state = "unstretched"
mass_per_length = "48.4 g/m"
axial_stiffness = "10 kN"
[platform]
mass = "0.4 kg"
static_tension = "5 N"
[[instrument]]
name = "daq"
rate = "1 kHz"
[[sensor]]
name = "tension_top"
kind = "tension"
at = 1.0
range = ["-10 N", "100 N"]
calibration = CALIBRATION
[limits]
"""


def rig(tmp_path, calibration):
    path = tmp_path / "bench.toml"
    path.write_text(RIG.replace("CALIBRATION", calibration), encoding="utf-8")
    return load_rig(path)


def test_a_rig_file_holds_its_pairs(tmp_path):
    written(tmp_path, "measured [mV/V],real [N]\n0,0\n2,100\n")
    found = rig(tmp_path, '{ log = "c.csv", order = 1 }').calibrations["tension_top"]
    assert [point.force for point in found.points] == [0.0, 100.0]
    pairs = '{ points = [["0 V", "0 N +/- 0.02 N"], ["2.5e-3 V", "10 kg +/- 1 g"]] }'
    found = rig(tmp_path, pairs).calibrations["tension_top"]
    assert found.kind == "voltage"
    assert found.points[1].measured == pytest.approx(2.5e-3)
    assert found.points[1].force == pytest.approx(98.05, abs=0.01)
    assert found.points[1].uncertainty == pytest.approx(9.8e-3, rel=1e-2)


@pytest.mark.parametrize(
    ("calibration", "words"),
    [
        ("{ order = 1 }", "neither log nor points"),
        ('{ log = "c.csv", points = [["0 V", "0 N"], ["1 V", "1 N"]] }', "both log and points"),
        ('{ log = "../c.csv" }', "expected a file beside the rig file"),
        ('{ log = "absent.csv" }', "absent.csv"),
        ('{ log = "c.csv", order = 9 }', "found the order 9"),
        ('{ points = [["0 V", "0 N"]] }', "found 1 pairs"),
        ('{ points = [["0 V", "0 N"], ["1 mV/V", "1 N"]] }', "bench.toml: .*outputs of kinds ratio, voltage"),
        ('{ points = [["0 V", "0 N"], ["1 V", "1 mm"]] }', "bench.toml: .*pair 2: .*quantity in N"),
    ],
)
def test_wrong_keys_of_a_calibration(tmp_path, calibration, words):
    with pytest.raises(TethertestError, match=words):
        rig(tmp_path, calibration)


def test_a_sensitivity_and_a_calibration_are_one_too_many(tmp_path):
    both = '{ points = [["0 V", "0 N"], ["1 V", "1 N"]] }\nsensitivity = "2 mV/V"\nrated = "100 N"'
    with pytest.raises(TethertestError, match="a sensitivity and a calibration"):
        rig(tmp_path, both)
