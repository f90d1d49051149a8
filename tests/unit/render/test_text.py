from fractions import Fraction

import pytest

from tethertest.render.text import fixed, number, percent, plus_minus, power_product


@pytest.mark.parametrize(
    ("value", "shown"),
    [
        (4.6, "4.600"),
        (-0.0012346, "−0.001235"),
        (9.9996, "10.00"),
        (123456.0, "123456"),
        (4.2e-5, "4.200×10⁻⁵"),
        (2.1e9, "2.100×10⁹"),
        (0.0, "0"),
        (float("nan"), "–"),
        (None, "–"),
    ],
)
def test_numbers_keep_four_digits(value, shown):
    assert number(value) == shown


def test_the_spread_decides_the_digits():
    assert plus_minus(1370.2123, 0.8036) == "1370.21 ± 0.80"
    assert plus_minus(-22.7, 12.5) == "−23 ± 12"
    assert plus_minus(0.300012, 8.2e-6) == "0.3000120 ± 0.0000082"
    assert plus_minus(1.5, float("nan")) == "1.500 ± unknown"


def test_no_negative_zero_is_shown():
    assert fixed(-1e-9, 3) == "0.000"


def test_percent_carries_its_sign_where_asked():
    assert percent(0.157, signed=True) == "+15.7 %"
    assert percent(-0.0086, signed=True) == "−0.86 %"


def test_exact_exponents_are_written_as_powers():
    exponents = {"omega": Fraction(1), "L": Fraction(2), "EA": Fraction(-1, 2), "g": Fraction(-1)}
    assert power_product(exponents) == "omega · L² / (EA^(1/2) · g)"
    assert power_product({"T": Fraction(-1)}) == "1 / T"
