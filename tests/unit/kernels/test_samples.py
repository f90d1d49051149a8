from __future__ import annotations

import numpy as np
import pytest

from tethertest.kernels import samples


def test_a_section_answers_an_impulse_as_its_difference_equation(run):
    numerator, denominator = np.array([0.2, 0.4, 0.2]), np.array([1.0, -0.5, 0.3])
    values, state = np.zeros(6), np.zeros(2)
    values[0] = 1.0
    run(samples.filter_section)(numerator, denominator, state, values)
    wanted = np.zeros(6)
    for index in range(6):
        wanted[index] = numerator[index] if index < 3 else 0.0
        wanted[index] -= sum(denominator[back] * wanted[index - back] for back in (1, 2) if index >= back)
    np.testing.assert_allclose(values, wanted, rtol=1e-14)


def test_a_section_goes_on_from_its_state(run):
    numerator, denominator = np.array([0.2, 0.4, 0.2]), np.array([1.0, -0.5, 0.3])
    whole = np.random.default_rng(0).normal(size=40)
    parts, state = whole.copy(), np.zeros(2)
    run(samples.filter_section)(numerator, denominator, state, parts[:17])
    run(samples.filter_section)(numerator, denominator, state, parts[17:])
    run(samples.filter_section)(numerator, denominator, np.zeros(2), whole)
    np.testing.assert_array_equal(parts, whole)


@pytest.mark.parametrize("derivative", [0, 1, 2])
def test_pieces_are_found_in_any_order_and_go_on_beyond_the_ends(run, derivative):
    knots = np.array([0.0, 1.0, 3.0, 3.5])
    # pieces of t^3, each from its own knot
    pieces = np.array([np.ones(3), 3 * knots[:-1], 3 * knots[:-1] ** 2, knots[:-1] ** 3])[:, :, None]
    times = np.array([3.2, -1.0, 0.5, 4.0, 1.0, 3.5, 2.0, 0.0])
    found = np.empty((times.size, 1))
    run(samples.evaluate_pieces)(knots, pieces, times, derivative, found)
    wanted = (times**3, 3 * times**2, 6 * times)[derivative]
    np.testing.assert_allclose(found[:, 0], wanted, rtol=1e-13, atol=1e-13)
