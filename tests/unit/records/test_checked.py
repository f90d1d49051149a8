"""A record is told what it cannot hold where it is made, with what to write in its place."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pint
import pytest

from tethertest.errors import DataError
from tethertest.records.cable import Air, Cable, Platform, PlatformMode
from tethertest.records.scene import Bottom, Geometry, Output, Top

METRES = pint.UnitRegistry().Quantity(3.0, "m")


@pytest.mark.parametrize(
    ("make", "found", "expected", "remedy"),
    [
        (lambda: Cable("3 m", "equilibrium", 0.05), "'3 m'", "a number in m", "as a number in m"),  # type: ignore[arg-type]
        (lambda: Cable(METRES, "equilibrium", 0.05), "3", "a number in m", "quantity.to('m').magnitude"),
        (lambda: Cable(3.0, "stretched", 0.05), "'stretched'", "'unstretched' or 'equilibrium'", "correct"),  # type: ignore[arg-type]
        (lambda: Cable(None, "equilibrium", 0.05), "None", "a number in m", "correct length"),  # type: ignore[arg-type]
        (lambda: Geometry("foo"), "'foo'", "'shallow' or 'straight'", "correct kind"),  # type: ignore[arg-type]
        (lambda: Bottom("harmonic", amplitude=True), "True", "a number in m or None", "correct"),
        (lambda: Output(1.0, 10.0, 1.0), "1.0", "a tuple, each a number", "correct gauges"),  # type: ignore[arg-type]
        (lambda: Output(1.0, 10.0, ("top",)), "('top',)", "a tuple, each a number", "correct gauges"),  # type: ignore[arg-type]
        (lambda: Air(1.2, wind="5 m/s"), "'5 m/s'", "a number in m/s", "as a number in m/s"),  # type: ignore[arg-type]
        (lambda: Top("platform", mass=[2.0]), "[2.0]", "a number in kg or None", "correct mass"),  # type: ignore[arg-type]
    ],
)
def test_another_type_is_refused_with_field_finding_and_remedy(
    make: Callable[[], Any], found: str, expected: str, remedy: str
) -> None:
    with pytest.raises(DataError) as caught:
        make()
    assert found in caught.value.problem
    assert expected in caught.value.problem
    assert remedy in caught.value.remedy


def test_what_numpy_and_lists_hold_are_numbers_and_tuples() -> None:
    cable = Cable(np.float64(3.0), "equilibrium", np.float32(0.05), axial_stiffness=1000)  # type: ignore[arg-type]
    assert cable.length == 3.0
    assert Output(1.0, 10.0, [0.0, 1.0]).gauges == [0.0, 1.0]  # type: ignore[arg-type,comparison-overlap]
    assert Air(1.2, wind=(1.0, 0.0, 0.0)).wind == (1.0, 0.0, 0.0)
    assert Platform(1.0, 5.0, {"free": PlatformMode()}, drag_area=(0.1, 0.1)).drag_area == (0.1, 0.1)
