"""Units that are answered without pint are answered as pint does."""

from __future__ import annotations

import subprocess
import sys

import pytest

from tethertest.errors import QuantityError
from tethertest.units import channel_scale, common, dimension_of, parse_quantity
from tethertest.units.channels import KINDS

SPELLINGS = [(written, unit) for unit, known in common.SI_UNITS.items() for written in known.factors]


@pytest.fixture
def without_table(monkeypatch):
    """Return what asks a question of pint alone."""

    def ask(question):
        with monkeypatch.context() as patched:
            patched.setattr(common, "SI_UNITS", {})
            patched.setattr("tethertest.units.dimensions.SI_UNITS", {})
            try:
                return question()
            except QuantityError as error:
                return str(error)

    return ask


def answered(question):
    try:
        return question()
    except QuantityError as error:
        return str(error)


@pytest.mark.parametrize(("written", "unit"), SPELLINGS)
def test_a_common_quantity_is_what_pint_makes_of_it(written, unit, without_table):
    def question():
        return parse_quantity(f"2.7 {written}", unit)

    assert answered(question) == without_table(question)


@pytest.mark.parametrize("written", sorted({written for written, _ in SPELLINGS}))
@pytest.mark.parametrize("kind", [None, *KINDS])
def test_a_common_unit_of_a_channel_is_what_pint_makes_of_it(written, kind, without_table):
    def question():
        return channel_scale(written, kind)

    assert answered(question) == without_table(question)


@pytest.mark.parametrize("unit", common.SI_UNITS)
def test_a_common_dimension_is_pints_in_its_order(unit, without_table):
    assert list(dimension_of(unit).items()) == list(without_table(lambda: dimension_of(unit)).items())


def test_common_units_do_not_load_pint():
    code = (
        "import sys; from tethertest.units import parse_quantity, channel_scale; "
        "parse_quantity('48.4 g/m +/- 0.5 %', 'kg/m'); channel_scale('kN', 'tension'); "
        "assert 'pint' not in sys.modules"
    )
    subprocess.run([sys.executable, "-c", code], check=True)
