"""Mistakes in rig and prototype files: file, line, key, what was found, what to do."""

import pytest

from tethertest.errors import RunFileError
from tethertest.readers import load_prototype_of, load_rig
from tethertest.records.rig import sensor_noise, sensor_range


def line_of(path, text):
    lines = path.read_text(encoding="utf-8").splitlines()
    return next(number for number, line in enumerate(lines, 1) if text in line)


#: old text, new text, key in the message, words of the message
MISTAKES = {
    "typo in a key": (
        'axial_stiffness = "10 kN"',
        'axial_stifness = "10 kN"',
        "cable.axial_stifness",
        "did you mean 'axial_stiffness'",
    ),
    "wrong dimension": (
        'rated = "100 N"',
        'rated = "100 mm"',
        "sensor.tension_top.rated",
        "expected a quantity in N",
    ),
    "unknown unit": ('rated = "100 N"', 'rated = "100 Nn"', "sensor.tension_top.rated", "is not known"),
    "no unit": ('length = "3 m"', "length = 3", "cable.length", 'write it as text with its unit: "3 m"'),
    "out of range": ("at = 0.5", "at = 1.5", "sensor.fbg1.at", "expected at most 1"),
    "negative": ('length = "3 m"', 'length = "-3 m"', "cable.length", "expected more than 0 m"),
    "missing": ('length = "3 m"\n', "", "cable.length", "is missing, expected a quantity in m"),
    "missing choice": ('length_state = "unstretched"\n', "", "cable.length_state", "is missing"),
    "unknown choice": ('"unstretched"', '"unstreched"', "cable.length_state", "did you mean 'unstretched'"),
    "unknown kind": (
        'kind = "tension"',
        'kind = "tensoin"',
        "sensor.tension_top.kind",
        "did you mean 'tension'",
    ),
    "missing table": ("[limits]", "[limit]", "limit", "did you mean 'limits'"),
    "key of another kind": (
        "at = 1.0",
        "at = 1.0\ngauge_factor = 0.78",
        "sensor.tension_top.gauge_factor",
        "does not belong to a tension sensor",
    ),
    "key that the kind needs": (
        'sensitivity = "2 mV/V"\n',
        "",
        "sensor.tension_top.sensitivity",
        "a tension sensor needs it",
    ),
    "half a temperature grating": (
        'capture = "2 nm"\nthermo_optic = "6.5e-6 1/delta_degC"\nnoise',
        "noise",
        "sensor.temp1.capture",
        "a temperature sensor needs it",
    ),
    "compensation of nothing": (
        '"temp1"\n\n',
        '"tmp1"\n\n',
        "sensor.fbg1.compensation",
        "did you mean 'temp1'",
    ),
    "compensation by a load cell": (
        'compensation = "temp1"',
        'compensation = "tension_top"',
        "sensor.fbg1.compensation",
        "a tension sensor",
    ),
    "same name": ('name = "fbg1"', 'name = "tension_top"', "sensor.tension_top.name", "a second time"),
    "overlapping captures": (
        'expected = "1560 nm"',
        'expected = "1553 nm"',
        "sensor.temp1.capture",
        "'fbg1' and 'temp1' overlap: 3 nm apart",
    ),
    "range in another unit": (
        '"-10 N", "100 N"',
        '"-10 mm", "100 N"',
        "sensor.tension_top.range",
        "expected a quantity in N",
    ),
    "range the wrong way": (
        '"-10 N", "100 N"',
        '"100 N", "-10 N"',
        "sensor.tension_top.range",
        "expected the lower limit first",
    ),
    "half a range": ('"-10 N", "100 N"', '"-10 N"', "sensor.tension_top.range[2]", "entry 2 is missing"),
    "noise in another unit": (
        'noise = "1 pm"',
        'noise = "1 mN"',
        "sensor.temp1.noise",
        "expected a quantity in m",
    ),
    "two stiffnesses": (
        'axial_stiffness = "10 kN"',
        'axial_stiffness = "10 kN"\nyoungs_modulus = "1 GPa"',
        "cable.youngs_modulus",
        "expected one of the two",
    ),
    "modulus without diameter": (
        'axial_stiffness = "10 kN"',
        'youngs_modulus = "1 GPa"',
        "cable.diameter",
        "beside youngs_modulus",
    ),
    "tension below the weight": (
        'static_tension = "5 N"',
        'static_tension = "1 N"',
        "platform.static_tension",
        "the cable's weight of 1.424 N",
    ),
    "order that is none": (
        'peak_tension = "10 %"',
        'order_amplitude = { first = "5 %" }',
        "limits.order_amplitude.first",
        '"1", "2", "1/2"',
    ),
    "date in quotes": (
        "at = 1.0",
        'at = 1.0\ncalibrated = "2026-03-01"',
        "sensor.tension_top.calibrated",
        "write it without quotes",
    ),
    "text without quotes": ('name = "bench"', "name = 3", "name", "put the value in double quotes"),
    "mode in another unit": (
        '"50 N/m"',
        '"50 N s/m"',
        "platform.modes.hold.hover_stiffness",
        "expected a quantity in N/m",
    ),
    "limit that lets everything pass": (
        'peak_tension = "10 %"',
        "peak_tension = 10",
        "limits.peak_tension",
        'expected at most 1\n  fix: correct the value; per cent is text: "10 %"',
    ),
    "sensitivity in V/V": (
        'sensitivity = "2 mV/V"',
        'sensitivity = "2 V/V"',
        "sensor.tension_top.sensitivity",
        "expected at most 0.1",
    ),
    "prototype given as a path": (
        'name = "bench"',
        'name = "bench"\nprototype = "../rigs/other"',
        "prototype",
        "expected the name of a prototype file",
    ),
    "uncertainty is no key": ("[limits]", "[uncertainty]\n[limits]", "uncertainty", "unknown key"),
}


@pytest.mark.parametrize(("old", "new", "key", "words"), MISTAKES.values(), ids=MISTAKES)
def test_a_mistake_is_told_with_file_key_and_remedy(bench, old, new, key, words):
    bench.spoil(bench.rig, old, new)
    with pytest.raises(RunFileError) as caught:
        load_rig(bench.rig)
    text = str(caught.value)
    assert text.startswith(str(bench.rig))
    assert f"{key}: " in text
    assert words in text
    assert "fix: " in text


def test_the_line_is_that_of_the_key(bench):
    bench.spoil(bench.rig, 'rated = "100 N"', 'rated = "100 mm"')
    with pytest.raises(RunFileError) as caught:
        load_rig(bench.rig)
    assert caught.value.line == line_of(bench.rig, "100 mm")


def test_all_mistakes_of_a_file_come_in_one_message_in_order_of_lines(bench):
    bench.spoil(bench.rig, 'mass = "0.4 kg"', 'mass = "0.4 N"')
    bench.spoil(bench.rig, 'rate = "1 kHz"', 'rate = "1 kHz"\nclock_drfit = "1 ppm"')
    bench.spoil(bench.rig, 'rated = "100 N"', 'rated = "100 mm"')
    bench.spoil(bench.rig, 'compensation = "temp1"', 'compensation = "temp2"')
    with pytest.raises(RunFileError) as caught:
        load_rig(bench.rig)
    text = str(caught.value)
    keys = ["platform.mass", "instrument.daq.clock_drfit", "sensor.tension_top.rated"]
    places = [text.index(f"{key}: ") for key in keys]
    assert places == sorted(places)


def test_checks_between_keys_run_beside_wrong_values(bench):
    bench.spoil(bench.rig, 'rated = "100 N"', 'rated = "100 mm"')
    bench.spoil(bench.rig, 'compensation = "temp1"', 'compensation = "temp2"')
    with pytest.raises(RunFileError, match="2 problems") as caught:
        load_rig(bench.rig)
    assert "sensor.fbg1.compensation" in str(caught.value)
    assert "sensor.tension_top.rated: is missing" not in str(caught.value)


def test_a_missing_file_names_what_is_there(bench):
    with pytest.raises(RunFileError, match=r"does not exist\n  fix: .*bench\.toml"):
        load_rig(bench.rig.with_name("bank.toml"))


def test_broken_toml_is_told_with_its_line(bench):
    bench.spoil(bench.rig, 'mass = "0.4 kg"', "mass = 0.4 kg")
    with pytest.raises(RunFileError, match=r"not valid TOML.*'mass = 0\.4 kg'") as caught:
        load_rig(bench.rig)
    assert caught.value.line == line_of(bench.rig, "mass = 0.4 kg")


def test_a_prototype_that_is_not_there_is_an_error(bench):
    bench.spoil(bench.rig, 'name = "bench"', 'name = "bench"\nprototype = "big"')
    with pytest.raises(RunFileError, match=r"big\.toml: the prototype file does not exist"):
        load_prototype_of(load_rig(bench.rig), bench.rig)


def test_a_rig_without_prototype_has_none(bench):
    assert load_prototype_of(load_rig(bench.rig), bench.rig) is None


def test_range_and_noise_are_in_si_and_a_grating_reads_a_wavelength(bench):
    bench.spoil(bench.rig, 'noise = "1 pm"', 'noise = "1 pm"\nrange = ["-20 degC", "60 degC"]')
    rig = load_rig(bench.rig)
    top, grating, thermometer = rig.sensor
    assert sensor_range(top) == (-10.0, 100.0)
    assert sensor_noise(top) == 0.0
    assert sensor_range(grating) == (-float("inf"), float("inf"))
    assert sensor_noise(thermometer) == pytest.approx(1e-12)
    assert sensor_range(thermometer) == pytest.approx((253.15, 333.15))
