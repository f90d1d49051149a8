"""The stability battery in short: what a million steps show, a few ten thousand must not break."""

from __future__ import annotations

from collections.abc import Callable

import pytest

from reports.stability import battery
from reports.stability.battery import Check

SHORT = 40_000


@pytest.mark.parametrize(
    "line",
    [
        lambda: battery.resonance(100, 1e-3),
        lambda: battery.resonance(10, 2e-2),
        battery.beyond_the_limit,
        lambda: battery.courant_numbers(120.0),
        lambda: battery.large_motion(600.0),
        battery.large_motion_without_viscosity,
        lambda: battery.energy(1.3, SHORT),
        lambda: battery.energy(5.0, SHORT),
        lambda: battery.energy(20.0, SHORT),
        lambda: battery.energy(300.0, SHORT),
        lambda: battery.rare_slack(SHORT),
        battery.pretensions,
        battery.masses,
        battery.implicit_damping,
        battery.light_cable,
    ],
)
def test_line_of_the_battery(line: Callable[[], Check]) -> None:
    check = line()
    assert check.met, f"{check.name}: asked {check.asked}, found {check.found}"


def test_energy_at_twice_the_transverse_speed_is_kept_below_courant_number_1() -> None:
    """At 1 itself the mesh resonates there; the solver stays away from it."""
    assert abs(battery.energy_drift(2.0, SHORT, courant=0.95, viscous=False)) < 2e-3


@pytest.mark.verify
def test_whole_battery_of_a_million_steps() -> None:
    missed = [f"{check.name}: {check.found}" for check in battery.battery() if not check.met]
    assert not missed
