"""The replay's filter and noise floor are those of scipy.signal."""

from __future__ import annotations

import numpy as np
from scipy.signal import firwin, welch

from tethertest.replay import motion
from tethertest.signal import flat_pass


def test_the_low_pass_is_a_kaiser_window_of_80_db():
    wanted = firwin(301, 0.1, window=("kaiser", 0.1102 * (80.0 - 8.7)))
    np.testing.assert_allclose(flat_pass._low_pass(0.1, 301), wanted, rtol=1e-12, atol=1e-15)


def test_the_power_density_is_welchs():
    values = np.random.default_rng(2).normal(size=3001)
    for length in (3001, 800, 801):
        axis, power = motion._power(values, 100.0, length)
        wanted_axis, wanted = welch(values, fs=100.0, nperseg=length, window="hann")
        np.testing.assert_allclose(axis, wanted_axis, rtol=1e-12)
        np.testing.assert_allclose(power, wanted, rtol=1e-9, atol=1e-15)
