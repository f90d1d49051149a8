"""Axial stiffness times strain against tension: agreement is noted, every usual slip is named."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from tethertest.conditioning import condition
from tethertest.conditioning.cross_check import COVERAGE, gains
from tethertest.conditioning.inertia import Inertia
from tethertest.records.channel import Window

from .conftest import PLACES

WINDOW = Window(11.0, 27.0)


def told(conditioned):
    return [item for item in conditioned.findings if item.kind == "strain_against_tension"]


def test_agreement_is_a_note_with_all_gains(bench):
    conditioned = condition(bench.run, bench.logs(), bench.priors)
    assert not told(conditioned)
    (note,) = [item for item in conditioned.findings if item.kind == "strain_over_tension"]
    assert note.severity == "note"
    found = gains(conditioned.channels, bench.run.rig, WINDOW, bench.priors.static_tension, Inertia(0.05))
    assert len(found) == 7  # two gratings against both cells and against each, and cell against cell
    for item in found:
        assert item.gain == pytest.approx(1.0, abs=0.01)
        assert abs(item.offset) < COVERAGE * item.offset_uncertainty
    # the noise of both alone: the jackknife error covers the scatter about 1
    assert 1e-4 < min(item.uncertainty for item in found) < 0.02


@pytest.mark.parametrize(
    ("factor", "words"),
    [(1 / 4.448, "4.448: tension in lbf read as N"), (1 / 9.80665, "9.81: tension in kgf"),
     (4.448, "1/4.448"), (1 / 0.78, "0.78: the gauge factor was left out")],
)  # fmt: skip
def test_one_load_cell_that_is_wrong_is_named_with_the_slip(bench, factor, words):
    """Strain over tension is the inverse of what the cell was spoilt with."""
    bench.columns["F_top"] = factor * (bench.columns["F_top"] - np.median(bench.columns["F_top"][:500]))
    (finding,) = told(condition(bench.run, bench.logs(), bench.priors))
    assert finding.subject == "tension_top"
    assert words in finding.text
    assert finding.severity == "warning"


def test_a_load_cell_with_the_wrong_sign_is_seen_by_the_other_one(bench):
    """The gratings' clock cannot be aligned then; the size of their motion is right."""
    bench.columns["F_top"] = -(bench.columns["F_top"] - np.median(bench.columns["F_top"][:500]))
    (finding,) = told(condition(bench.run, bench.logs(), bench.priors))
    assert finding.subject == "load cells"
    assert "a sign" in finding.text


def test_a_wrong_stiffness_is_told_of_the_cable(bench):
    rig = replace(bench.run.rig, cable=replace(bench.run.rig.cable, axial_stiffness=14_000.0))
    (finding,) = told(condition(replace(bench.run, rig=rig), bench.logs(), bench.priors))
    assert finding.subject == "cable"
    assert "is 1.397" in finding.text
    assert "axial_stiffness" in finding.text


def test_a_wrong_gauge_factor_is_told_of_its_grating(bench):
    sensors = tuple(
        replace(item, gauge_factor=1.2) if item.name == "fbg2" else item for item in bench.run.rig.sensor
    )
    run = replace(bench.run, rig=replace(bench.run.rig, sensor=sensors))
    (finding,) = told(condition(run, bench.logs(), bench.priors))
    assert finding.subject == "fbg2"
    assert "is 0.65" in finding.text


def test_a_stated_uncertainty_covers_a_stiffness_that_is_off_by_as_much(bench):
    cable = replace(bench.run.rig.cable, axial_stiffness=10_500.0)
    uncertain = {**bench.run.rig.uncertainty, "cable.axial_stiffness": 300.0}
    rig = replace(bench.run.rig, cable=cable, uncertainty=uncertain)
    assert not told(condition(replace(bench.run, rig=rig), bench.logs(), bench.priors))
    exact = replace(rig, uncertainty={})
    assert told(condition(replace(bench.run, rig=exact), bench.logs(), bench.priors))


def test_a_tension_that_hardly_moves_tells_nothing(bench):
    conditioned = condition(bench.run, bench.logs(), bench.priors)
    still = Window(0.3, 1.9)
    assert not gains(conditioned.channels, bench.run.rig, still, bench.priors.static_tension, Inertia(0.0))


def test_clipped_peaks_do_not_tilt_the_comparison(bench):
    limit = float(np.round(np.quantile(bench.columns["F_top"], 0.9), 6))
    bench.columns["F_top"] = np.minimum(bench.columns["F_top"], limit)
    conditioned = condition(bench.run, bench.logs(), bench.priors)
    assert not told(conditioned)


def spread_by_inertia(bench, share):
    """Take as much from the tension at the bottom, and less towards the top, as the cable's mass does."""
    for name, place in (("F_bottom", 0.0), *PLACES.items()):
        rest = np.median(bench.columns[name][:300])
        bench.columns[name] = rest + (1.0 - share * (1.0 - place)) * (bench.columns[name] - rest)


def test_what_inertia_may_be_is_no_fault_of_a_cell_though_no_motion_was_measured(bench):
    """Mass times acceleration of the cable is 3 % of the tension here."""
    spread_by_inertia(bench, 0.03)
    run = bench.with_file(log=bench.run.file.log[:2])
    conditioned = condition(run, bench.logs(), bench.priors)
    assert conditioned.channel("heave") is None
    assert not told(conditioned)
    (note,) = [item for item in conditioned.findings if item.kind == "strain_over_tension"]
    assert "no bottom motion was measured" in note.text


@pytest.mark.parametrize(
    ("logs", "radius", "words"),
    [(2, 0.05, "no bottom motion was measured"), (3, 0.07, "[drive] radius is 0.07 m, heave moves by")],
)
def test_more_than_inertia_is_told_with_what_is_not_known_of_the_motion(bench, logs, radius, words):
    bench.columns["F_bottom"] = 0.88 * (
        bench.columns["F_bottom"] - np.median(bench.columns["F_bottom"][:300])
    )
    file = {"log": bench.run.file.log[:logs], "drive": replace(bench.run.file.drive, radius=radius)}
    (finding,) = told(condition(bench.with_file(**file), bench.logs(), bench.priors))
    assert finding.subject == "tension_bottom"
    assert words in finding.text


def test_a_motion_that_is_not_as_stated_accuses_no_cell(bench):
    """The encoder shows half the motion, so half the inertia."""
    spread_by_inertia(bench, 0.04)
    bench.columns["heave"] = 0.5 * bench.columns["heave"]
    assert not told(condition(bench.run, bench.logs(), bench.priors))
    believed = replace(bench.run.file.drive, radius=0.025)
    assert told(condition(bench.with_file(drive=believed), bench.logs(), bench.priors))
