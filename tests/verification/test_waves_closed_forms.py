"""Waves up and down a straight cable against closed forms: reflection, standing-wave ratio, place and time.

A cable driven at its foot, its top resisting by R: ``r = (R - Z)/(R + Z)`` at every frequency and section,
``|up| = Z A w/|1 - r exp(-2ikL)|``.
"""

from __future__ import annotations

import math
from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from reports.clock_errors.rig import RIG
from reports.wave_energy.steady import steady_state
from tethertest.jobs.wave_findings import largest_tension, replayed_waves
from tethertest.records.cable import Cable
from tethertest.records.channel import Window
from tethertest.records.lines import DriveFit
from tethertest.records.response import Response
from tethertest.records.scene import Bottom, Geometry, Output, Scene, Top
from tethertest.records.waves import OrderWaves
from tethertest.solver import solve

LENGTH, MASS, STIFFNESS, AMPLITUDE = 150.0, 0.0484, 10020.0, 0.1
IMPEDANCE, SPEED = math.sqrt(STIFFNESS * MASS), math.sqrt(STIFFNESS / MASS)
FREQUENCIES = (0.3, 1.1, 1.6)  # the first traverse resonance c/2L is at 1.52 Hz
START, PERIODS = 20.0, 20
SURE = replace(RIG, uncertainty={})


def upright(frequency: float, resistance: float) -> Scene:
    return Scene(
        "bar",
        Cable(LENGTH, "unstretched", MASS, axial_stiffness=STIFFNESS),
        Geometry("vertical"),
        Bottom(
            "harmonic",
            direction="vertical",
            amplitude=AMPLITUDE,
            frequency=frequency,
            start="ramp",
            ramp=10.0,
        ),
        Top(
            "platform",
            mass=0.0,
            static_tension=200.0,
            hover_stiffness=(1e3, 0.0),
            hover_damping=(0.0, resistance * IMPEDANCE),
        ),
        Output(START + PERIODS / frequency, 100.0, (0.0, 0.3, 1.0), ("velocity",)),
    )


@cache
def solved(frequency: float, resistance: float) -> Response:
    return solve(upright(frequency, resistance), fidelity="linear")


def first_orders(response: Response) -> list[OrderWaves]:
    frequency = response.scene.bottom.frequency or 0.0
    window = Window(START, START + PERIODS / frequency)
    found = replayed_waves(response, 0.0, DriveFit(frequency, 1e-7, ()), window, SURE)
    assert len(found.parts) == 3
    return [next(order for order in part.orders if order.order == "1") for part in found.parts]


@pytest.mark.parametrize("frequency", FREQUENCIES)
@pytest.mark.parametrize("resistance", [3.0, 0.2])
def test_a_top_that_resists_sets_the_ratio_whatever_the_frequency(
    frequency: float, resistance: float
) -> None:
    reflection = (resistance - 1.0) / (resistance + 1.0)
    number = 2.0 * math.pi * frequency / SPEED
    going = IMPEDANCE * AMPLITUDE * 2.0 * math.pi * frequency
    going /= abs(1.0 - reflection * np.exp(-2j * number * LENGTH))
    for waves in first_orders(solved(frequency, resistance)):
        assert waves.up == pytest.approx(going, rel=1e-3)
        assert waves.energy_ratio == pytest.approx(reflection**2, rel=1e-3)
        assert waves.standing_wave_ratio == pytest.approx(max(resistance, 1.0 / resistance), rel=1e-3)


@pytest.mark.parametrize("frequency", FREQUENCIES)
def test_a_matched_top_returns_nothing_and_takes_what_the_drive_does(frequency: float) -> None:
    response = solved(frequency, 1.0)
    speed = AMPLITUDE * 2.0 * math.pi * frequency
    for waves in first_orders(response):
        assert waves.up == pytest.approx(IMPEDANCE * speed, rel=1e-3)
        assert waves.down < 1e-3 * waves.up
        assert waves.power == pytest.approx(0.5 * IMPEDANCE * speed**2, rel=2e-3)
    rows = slice(np.searchsorted(response.time, START), None)
    velocity = response.fields["velocity"][rows, 0, 2]
    work = -float(np.mean((response.tension[rows, 0] - response.tension[0, 0]) * velocity))
    assert work == pytest.approx(0.5 * IMPEDANCE * speed**2, rel=0.02)  # not of whole periods to the sample


def test_waves_are_told_before_a_slack_interval_outside_the_window_but_not_in_one_that_has_it() -> None:
    response = solved(1.1, 3.0)
    window, drive = Window(START, 30.0), DriveFit(1.1, 1e-7, ())
    later = replace(response, slack={0.0: ((31.0, 32.0),)})
    assert replayed_waves(later, 0.0, drive, window, SURE).parts
    earlier = replace(response, slack={0.0: ((5.0, 6.0),)})
    assert replayed_waves(earlier, 0.0, drive, window, SURE).parts
    within = replace(response, slack={0.0: ((29.0, 32.0),)})
    refused = replayed_waves(within, 0.0, drive, window, SURE)
    assert not refused.parts
    assert "slack" in refused.remarks[0]


def test_the_largest_tension_is_told_to_the_row_of_its_gauge() -> None:
    response = solved(1.6, 3.0)
    found = largest_tension(response, 7.0)
    row = int(np.argmax(response.tension[:, -1]))
    assert found.at == 1.0
    assert found.time == pytest.approx(7.0 + response.time[row], abs=1e-9)
    # gravity apart, the top is largest where its velocity is most downwards: F = -R v
    velocity = response.fields["velocity"][:, -1, 2]
    assert response.time[row] == pytest.approx(response.time[int(np.argmin(velocity))], abs=0.011)


def test_most_above_rest_is_told_apart_from_the_weight() -> None:
    response = solved(1.6, 3.0)
    found = largest_tension(response)
    below_top = LENGTH * np.linspace(0.0, 1.0, 2001)
    wave, r = 2.0 * np.pi * 1.6 / SPEED, 0.5  # k, and (R - Z)/(R + Z) for R = 3 Z
    amplitude = IMPEDANCE * AMPLITUDE * 2.0 * np.pi * 1.6 * np.abs(1.0 + r * np.exp(-2j * wave * below_top))
    amplitude /= abs(1.0 - r * np.exp(-2j * wave * LENGTH))
    assert found.over_rest == pytest.approx(float(amplitude.max()), rel=0.02)
    there = np.interp(LENGTH * (1.0 - found.over_rest_at), below_top, amplitude)
    assert there == pytest.approx(float(amplitude.max()), rel=0.02)
    assert found.over_rest_at < 0.2 < found.at


def straight(frequency: float, top: Top) -> Scene:
    return replace(
        upright(frequency, 1.0),
        geometry=Geometry("straight", tension=200.0),
        bottom=Bottom("harmonic", amplitude=AMPLITUDE, frequency=frequency),
        top=top,
        gravity=0.0,
    )


@pytest.mark.parametrize("frequency", [0.4, 1.1, 2.1, 3.7])
def test_under_a_fixed_top_waves_stand_with_their_largest_every_half_wave_below_it(frequency: float) -> None:
    steady = steady_state(straight(frequency, Top("fixed")), stations=201)
    number = 2.0 * math.pi * frequency / SPEED
    below = LENGTH * (1.0 - np.linspace(0.0, 1.0, 201))  # distance from the top, of the unstretched cable
    going = IMPEDANCE * AMPLITUDE * 2.0 * math.pi * frequency
    closed = going * np.abs(np.cos(number * below) / math.sin(number * LENGTH))
    force = np.abs(steady.axial.up + steady.axial.down)
    np.testing.assert_allclose(force, closed, atol=1e-9 * closed.max())
    np.testing.assert_allclose(np.abs(steady.axial.up), np.abs(steady.axial.down), rtol=1e-9)
    assert steady.work == pytest.approx(0.0, abs=1e-9 * going)
    half_wave = SPEED / (2.0 * frequency)
    if half_wave < LENGTH:
        row = int(np.argmin(np.abs(below - half_wave)))
        assert force[row] == pytest.approx(force[-1], rel=3e-3)
        assert max(force[row - 20], force[row + 20]) < 0.98 * force[row]


@pytest.mark.parametrize("frequency", [0.4, 1.1, 2.1])
def test_a_mass_on_top_moves_the_largest_tension_by_its_phase(frequency: float) -> None:
    mass = 2.0
    steady = steady_state(straight(frequency, Top("platform", mass=mass)), stations=201)
    angular = 2.0 * math.pi * frequency
    # F(L) = M w^2 u(L): with d from the top u ~ cos(k d + phi), F ~ sin(k d + phi), tan(phi) = M w/Z
    phase = math.atan2(mass * angular, IMPEDANCE)
    below = LENGTH * (1.0 - np.linspace(0.0, 1.0, 201))
    number = angular / SPEED
    size = IMPEDANCE * AMPLITUDE * angular / abs(math.cos(number * LENGTH + phase))
    force = np.abs(steady.axial.up + steady.axial.down)
    np.testing.assert_allclose(
        force, size * np.abs(np.sin(number * below + phase)), atol=1e-9 * float(force.max())
    )


def test_the_closed_form_of_the_study_takes_in_what_leaves_at_the_top() -> None:
    top = Top("platform", mass=0.0, hover_stiffness=(1e3, 0.0), hover_damping=(0.0, IMPEDANCE))
    steady = steady_state(straight(1.1, top))
    speed = AMPLITUDE * 2.0 * math.pi * 1.1
    assert np.max(np.abs(steady.axial.down)) < 1e-9 * IMPEDANCE * speed
    assert steady.work == pytest.approx(0.5 * IMPEDANCE * speed**2, rel=1e-9)
    np.testing.assert_allclose(steady.axial.power, steady.work, rtol=1e-9)
