"""Where the tension that a motion asks for is known: not after a hole, and not at a moving end."""

from __future__ import annotations

import numpy as np
import pytest

from tethertest.conditioning.clocks.signals import expected_signals
from tethertest.records.channel import Channel, Flag

STEP, WORN = 2e-3, 0.04
TIME = np.arange(10_000) * STEP


def channel(kind: str, unit: str) -> Channel:
    values = np.sin(2.0 * np.pi * 0.5 * TIME)
    return Channel(kind, kind, unit, TIME, values, np.zeros(TIME.size, np.uint16))


def unknown(hole: int = 0, at_rest: tuple[bool, bool] = (True, True)) -> np.ndarray:
    """Return times at which the expected tension is not known, with so many samples lost at 8 s."""
    lost = (np.arange(TIME.size) >= 4000) & (np.arange(TIME.size) < 4000 + hole)
    heave = channel("displacement", "m").with_flags(lost, Flag.MISSING)
    tension = channel("tension", "N")
    found = expected_signals(tension, heave, 500.0, tension, 50.0, (), at_rest=at_rest)
    assert found is not None
    lacking = found.clock.time[~found.clock.usable]
    # the low-pass wears the very ends of any record
    return lacking[(lacking > WORN) & (lacking < TIME[-1] - WORN)]


def test_a_hole_of_fifty_milliseconds_is_bridged_and_a_longer_one_makes_the_rig_settle() -> None:
    short = unknown(hole=25)
    assert (short.min(), short.max()) == pytest.approx((8.0, 8.048), abs=1.5 * WORN)
    long = unknown(hole=26)
    assert (long.min(), long.max()) == pytest.approx((8.0, 8.05 + 2.5), abs=1.5 * WORN)


def test_a_record_cut_in_motion_is_known_once_the_rig_has_settled() -> None:
    assert unknown().size == 0
    begun = unknown(at_rest=(False, True))
    assert (begun.min(), begun.max()) == pytest.approx((0.0, 2.5), abs=1.5 * WORN)
    ended = unknown(at_rest=(True, False))
    assert (ended.min(), ended.max()) == pytest.approx((19.5, 20.0), abs=1.5 * WORN)
