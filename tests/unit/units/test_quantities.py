"""Text with units becomes SI, and every trap of the unit library is met."""

from __future__ import annotations

from fractions import Fraction

import pytest

from tethertest.errors import QuantityError
from tethertest.units import channel_scale, dimension_of, format_quantity, parse_quantity


@pytest.mark.parametrize(
    ("text", "unit", "value"),
    [
        ("48.4 g/m", "kg/m", 0.0484),
        ("10.02 kN", "N", 10020.0),
        ("120 rpm", "Hz", 2.0),  # not 12.57: a revolution is no radian here
        ("18 cycles/min", "Hz", 0.3),
        ("0.3 cycle/s", "Hz", 0.3),
        ("0.3 rps", "Hz", 0.3),
        ("0.3 turn/s", "Hz", 0.3),
        ("18 rev/min", "Hz", 0.3),
        ("18 U/min", "Hz", 0.3),
        ("18 cpm", "Hz", 0.3),
        ("5 %", "1", 0.05),
        (0.25, "1", 0.25),
        ("6.5e-6 1/delta_degC", "1/K", 6.5e-6),
        ("20 degC", "K", 293.15),  # an offset unit that pint refuses
        ("10 deg", "rad", 0.17453292519943295),
        ("2.013 mV/V", "1", 2.013e-3),
        ("5 N s/m", "N s/m", 5.0),
        ("9.81 m/s2", "m/s^2", 9.81),
        ("-3 mm", "m", -0.003),
        ("100 ppm", "1", 1e-4),
    ],
)
def test_a_quantity_becomes_si(text: str | float, unit: str, value: float) -> None:
    assert parse_quantity(text, unit).value == pytest.approx(value, rel=1e-12)


@pytest.mark.parametrize(
    ("text", "unit", "message"),
    [
        ("3 Nm", "N", "dimension"),  # not a yarn count
        ("1,5 kN", "N", "decimal comma"),
        (5, "N", "bare number"),
        ("5", "N", "without a unit"),
        ("5 foo", "N", "not known"),
        ("2 rad/s", "Hz", "angular frequency"),
        ("108 deg/s", "Hz", "angular frequency"),
        ("nan N", "N", "expected a number"),
        ("1e999 N", "N", "not a finite number"),
        ("5 N/", "N", "cannot be read"),
        ("1 N +/- -2 N", "N", "negative uncertainty"),
        ("1 N +/- 2 N +/- 3 N", "N", "more than one"),
        (True, "1", "expected a quantity"),
        ("1 kg", "m", "dimension"),
    ],
)
def test_what_is_no_such_quantity_is_refused_with_a_remedy(text: object, unit: str, message: str) -> None:
    with pytest.raises(QuantityError, match=message) as caught:
        parse_quantity(text, unit)  # type: ignore[arg-type]
    assert caught.value.remedy


@pytest.mark.parametrize(
    ("text", "uncertainty"),
    [
        ("10.02 kN +/- 0.2 kN", 200.0),
        ("10.02 kN ± 200 N", 200.0),
        ("10.02 +/- 0.2 kN", 200.0),
        ("10 kN +/- 2 %", 200.0),
    ],
)
def test_an_uncertainty_is_kept(text: str, uncertainty: float) -> None:
    assert parse_quantity(text, "N").uncertainty == pytest.approx(uncertainty)


@pytest.mark.parametrize(
    ("text", "uncertainty"),
    [
        ("2.013 mV/V +/- 0.1 %", 2.013e-6),  # as a data sheet has it
        ("0.78 +/- 0.5 %", 0.0039),
        ("1.2 +/- 10 %", 0.12),
        ("5 % +/- 1 %", 0.01),  # of the same kind as the value
        ("5 % +/- 0.01", 0.01),
    ],
)
def test_per_cent_is_a_share_of_a_value_that_is_not_in_per_cent(text: str, uncertainty: float) -> None:
    assert parse_quantity(text, "1").uncertainty == pytest.approx(uncertainty)


@pytest.mark.parametrize("written", ["um/m", "%", "1", "ppm"])
def test_a_bridge_puts_out_volt_over_volt(written: str) -> None:
    """An amplifier's um/m holds its gauge factor: with k = 2, 1 mV/V is 2000 um/m."""
    with pytest.raises(QuantityError, match="no output of a bridge"):
        channel_scale(written, "ratio")


@pytest.mark.parametrize(
    ("written", "factor"), [("mV/V", 1e-3), ("V/V", 1.0), ("uV/V", 1e-6), ("mV / V", 1e-3)]
)
def test_ratios_of_a_bridge(written: str, factor: float) -> None:
    assert channel_scale(written, "ratio").factor == pytest.approx(factor)


@pytest.mark.parametrize("written", ["MV", "MV/V", "NM"])
def test_capitals_that_may_be_another_unit_are_refused(written: str) -> None:
    with pytest.raises(QuantityError, match="written in capitals and may be"):
        channel_scale(written)


@pytest.mark.parametrize("written", ["degC", "°C", "degree_Celsius", "degreeC", "degrees_C", "Celsius"])
def test_every_spelling_of_celsius_has_its_zero(written: str) -> None:
    scale = channel_scale(written)
    assert (scale.unit, scale.factor, scale.offset) == ("K", 1.0, 273.15)


@pytest.mark.parametrize(
    ("written", "kind", "found", "factor"),
    [
        ("kN", None, "tension", 1000.0),
        ("kg", "tension", "tension", 9.80665),
        ("lb", "tension", "tension", 4.4482216152605),
        ("t", "tension", "tension", 9806.65),
        ("g", "acceleration", "acceleration", 9.80665),
        ("um\\m", "strain", "strain", 1e-6),
        ("µm/m", "strain", "strain", 1e-6),
        ("nm", None, "wavelength", 1e-9),
        ("mV/V", None, "ratio", 1e-3),
        ("Volts", None, "voltage", 1.0),
        ("m/s2", None, "acceleration", 1.0),
        ("mm", None, "displacement", 1e-3),
        ("count", None, "count", 1.0),
        ("nm/m", None, "strain", 1e-9),
        ("deg", None, "other", 1.0),
        ("bit", None, "other", 1.0),
        ("-", None, "other", 1.0),
        ("", None, "other", 1.0),
    ],
)
def test_a_channel_unit_is_read_by_its_kind(
    written: str, kind: str | None, found: str, factor: float
) -> None:
    scale = channel_scale(written, kind)
    assert scale.kind == found
    assert scale.factor == pytest.approx(factor)


def test_fahrenheit_has_an_offset_and_a_factor() -> None:
    scale = channel_scale("degF")
    assert scale.factor * 212.0 + scale.offset == pytest.approx(373.15)
    assert scale.factor * 32.0 + scale.offset == pytest.approx(273.15)


def test_celsius_has_an_offset() -> None:
    scale = channel_scale("Deg C")
    assert (scale.kind, scale.factor, scale.offset) == ("temperature", 1.0, 273.15)


@pytest.mark.parametrize(
    ("written", "kind"),
    [("N", "displacement"), ("mm", "tension"), ("foo", "tension"), ("RN", "tension"), ("dB", "temperature")],
)
def test_a_unit_that_does_not_belong_to_the_kind_is_refused(written: str, kind: str) -> None:
    with pytest.raises(QuantityError):
        channel_scale(written, kind)


def test_dimensions_are_exact() -> None:
    assert dimension_of("N s/m") == {"M": Fraction(1), "T": Fraction(-1)}
    assert dimension_of("1") == {}


@pytest.mark.parametrize(
    ("value", "unit", "text"),
    [
        (10020.0, "N", "10.02 kN"),
        (0.0012, "m", "1.2 mm"),
        (0.25, "1", "0.25"),
        (0.0, "N", "0 N"),
        (3.0, "kg", "3 kg"),
    ],
)
def test_numbers_are_written_for_people(value: float, unit: str, text: str) -> None:
    assert format_quantity(value, unit) == text
