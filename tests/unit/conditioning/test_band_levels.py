"""What is slow between two records and is fitted along."""

from __future__ import annotations

import numpy as np
import pytest

from tethertest.conditioning.clocks.alignment import levels


def test_levels_are_a_parabola_and_cosines_up_to_a_frequency() -> None:
    time = 3.0 + np.arange(1001) / 100.0
    found = levels(time, 0.21)
    # half cycles over ten seconds up to 0.21 Hz: four
    assert found.shape == (1001, 3 + 4)
    share = np.linspace(0.0, 1.0, 1001)
    expected = [np.ones(1001), share - 0.5, (share - 0.5) ** 2]
    expected += [np.cos(np.pi * number * share) for number in (1, 2, 3, 4)]
    assert found == pytest.approx(np.column_stack(expected), abs=1e-9)
    assert levels(time, 0.01).shape == (1001, 3)
