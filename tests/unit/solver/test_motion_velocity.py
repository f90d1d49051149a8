"""The closed-form velocity against differences of the displacement, and its values where it jumps."""

from __future__ import annotations

import numpy as np
import pytest

from tethertest.errors import DataError
from tethertest.records.arrays import FloatArray
from tethertest.records.scene import Bottom, MeasuredMotion
from tethertest.solver.motion import displacement, velocity

SAMPLES = np.linspace(0.0, 6.0, 61)
DATA = MeasuredMotion(SAMPLES, 0.3 * np.sin(1.3 * SAMPLES))
MOTIONS = {
    "fixed": Bottom("fixed"),
    "step": Bottom("step", velocity=-0.4),
    "harmonic, jump": Bottom("harmonic", amplitude=0.2, frequency=0.3),
    "harmonic, ramp": Bottom("harmonic", amplitude=0.2, frequency=0.3, start="ramp", ramp=2.5),
    "crank, jump": Bottom("crank-slider", radius=0.1, rod_ratio=0.25, frequency=0.4),
    "crank, ramp": Bottom("crank-slider", radius=0.1, rod_ratio=0.6, frequency=0.4, start="ramp", ramp=3.0),
    "crank without rod": Bottom("crank-slider", radius=0.1, rod_ratio=0.0, frequency=0.4),
    "measured": Bottom("measured"),
}


def differences(bottom: Bottom, time: FloatArray, span: float) -> FloatArray:
    """Centred differences of fourth order."""
    at = [displacement(bottom, time + k * span, DATA) for k in (-2, -1, 1, 2)]
    return np.asarray((at[0] - 8.0 * at[1] + 8.0 * at[2] - at[3]) / (12.0 * span))


@pytest.mark.parametrize("bottom", MOTIONS.values(), ids=MOTIONS)
def test_velocity_is_the_difference_of_the_displacement(bottom: Bottom) -> None:
    time = np.linspace(0.013, 5.937, 199)
    # a span that straddles a knot of the spline or the ramp's end sees a jump of the third derivative
    np.testing.assert_allclose(
        velocity(bottom, time, DATA), differences(bottom, time, 1e-4), rtol=0.0, atol=2e-8
    )


@pytest.mark.parametrize("bottom", MOTIONS.values(), ids=MOTIONS)
def test_velocity_is_zero_before_the_start(bottom: Bottom) -> None:
    assert velocity(bottom, np.array([-1.0, -1e-12]), DATA).tolist() == [0.0, 0.0]


@pytest.mark.parametrize(
    ("name", "expected"),
    [
        ("step", -0.4),
        ("harmonic, jump", 0.2 * 2.0 * np.pi * 0.3),
        ("harmonic, ramp", 0.0),
        ("crank, jump", 0.1 * 2.0 * np.pi * 0.4),
        ("crank, ramp", 0.0),
        ("measured", 0.3 * 1.3),
    ],
)
def test_velocity_at_the_start_is_the_one_just_after_it(name: str, expected: float) -> None:
    assert velocity(MOTIONS[name], np.zeros(1), DATA)[0] == pytest.approx(expected, rel=1e-3, abs=1e-15)


def test_measured_motion_goes_on_with_uniform_acceleration() -> None:
    """A free fall that ends with its record falls on: x = a t^2/2, v = a t."""
    time = np.linspace(0.0, 2.0, 201)
    fall = MeasuredMotion(time, 1.5 * time**2)
    beyond = np.array([2.0, 2.01, 2.1])
    np.testing.assert_allclose(displacement(MOTIONS["measured"], beyond, fall), 1.5 * beyond**2, rtol=1e-9)
    np.testing.assert_allclose(velocity(MOTIONS["measured"], beyond, fall), 3.0 * beyond, rtol=1e-9)


@pytest.mark.parametrize(
    ("bottom", "word"),
    [
        (Bottom("step"), "velocity"),
        (Bottom("measured"), "data"),
        (Bottom("harmonic", frequency=1.0), "amplitude"),
        (Bottom("harmonic", amplitude=1.0, frequency=1.0, start="ramp"), "ramp"),
    ],
)
def test_a_missing_key_is_named(bottom: Bottom, word: str) -> None:
    with pytest.raises(DataError, match=word):
        velocity(bottom, np.zeros(1))
