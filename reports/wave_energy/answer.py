"""The article's second and third conclusion against the sweep, in words with its numbers."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

import numpy as np

from reports.wave_energy.cases import FIGURE_8
from reports.wave_energy.maps import Largest
from reports.wave_energy.orders import SettledRun
from reports.wave_energy.sweep import Sweep

#: a drive within this share of a natural frequency is near it
NEAR: Final = 0.04
#: and beyond this one away from it
AWAY: Final = 0.10
#: by this much the middle must exceed both ends to count: half the mesh changes no largest tension by more
CLEARLY: Final = 1.05


def answers(sweep: Sweep) -> tuple[str, ...]:
    """Return one paragraph for each part of the two conclusions."""
    return (
        _place_started(sweep),
        _place_settled(sweep),
        _shapes(sweep),
        _lossless(sweep),
        _air(sweep),
        _top(sweep),
    )


def _place_started(sweep: Sweep) -> str:
    def at(model: str) -> str:
        found = [run.largest for run in sweep.started if run.model == model and run.frequency in (0.18, 0.24)]
        return " and ".join(_place(one) for one in found)

    def inside(model: str) -> int:
        return sum(run.largest.middle_over_ends > CLEARLY for run in sweep.started if run.model == model)

    count = sum(run.model == "exact" for run in sweep.started)
    instants = " and ".join(f"{sweep.start(frequency, 'exact').in_middle:.0%}" for frequency in (0.18, 0.24))
    return (
        "**Third conclusion, Figs 8b and 8c: the largest tension also comes in the middle of the cable.** "
        f"At 0.18 and 0.24 Hz the printed scheme gives {at('printed')}, as the article reports. The "
        f"article's own equations, solved with each wave at its own speed, give {at('linear')}; the exact "
        "cable "
        f"{at('exact')}. Over the sweep the middle exceeds both ends by more than {CLEARLY - 1.0:.0%} at "
        f"{inside('printed')} of {count} drives as printed, at {inside('linear')} by the equations and at "
        f"{inside('exact')} for the exact cable. From the article's start, then, the conclusion rests on the "
        "printed scheme. Below a fixed top the next largest tension of a standing wave lies half a wave "
        "length down, at 1 - c/2fL of the length. The printed scheme has c = ct = 63 m/s for the axial "
        "wave, too: "
        f"{_antinode(63.25, 0.18):.2f} at 0.18 Hz and {_antinode(63.25, 0.24):.2f} at 0.24 Hz; with c1 = 100 "
        f"m/s that place does not exist below {100.04 / 500.0:.2f} Hz and is "
        f"{_antinode(100.04, 0.24):.2f} at 0.24 Hz. If no more is meant than that the largest tension of "
        "some instant lies in the middle, it "
        f"always holds: for the exact cable in {instants} of the instants at 0.18 and 0.24 Hz."
    )


def _antinode(speed: float, frequency: float, length: float = 250.0) -> float:
    return 1.0 - speed / (2.0 * frequency * length)


def _place(found: Largest) -> str:
    share = found.middle_over_ends - 1.0
    return f"{found.value:.1f} N at {found.place:.2f} of the length (middle {share:+.0%} against the ends)"


def _place_settled(sweep: Sweep) -> str:
    runs = [run for run in sweep.of_case("article") if run.is_settled]
    inner = [run for run in runs if run.largest.middle_over_ends > CLEARLY]
    most = max(inner, key=lambda run: run.largest.middle_over_ends)
    air = [run for run in sweep.of_case("air") if run.largest.middle_over_ends > CLEARLY]
    return (
        "**Where it holds.** Once the motion has settled, the middle does exceed both ends by more than "
        f"{CLEARLY - 1.0:.0%} without loss at {_list(inner)} Hz ({len(inner)} of {len(runs)} settled "
        f"drives), most at {most.frequency:.2f} Hz: {most.largest.value:.1f} N at "
        f"{most.largest.place:.2f} of "
        f"the length at phase {most.largest.phase:.2f}, {most.largest.middle_over_ends - 1.0:.0%} above "
        "the ends; with "
        f"air drag at {_list(air)} Hz. Near the axial resonance (0.17 to 0.20 Hz) it is always an end."
    )


def _list(runs: Sequence[SettledRun]) -> str:
    return ", ".join(f"{run.frequency:.2f}" for run in runs)


def _shapes(sweep: Sweep) -> str:
    def near(model: str, frequency: float) -> float:
        return next(r.share for r in sweep.started if r.model == model and r.frequency == frequency)

    def shares(model: str) -> str:
        return ", ".join(f"{near(model, frequency):.2f}" for frequency in FIGURE_8)

    return (
        "**Second conclusion: standing waves near a natural frequency, travelling ones away from it.** As a "
        "picture of F(s, t) from the article's start, one shape holds at 0.13, 0.18, 0.24 and 0.30 Hz "
        f"{shares('printed')} of the mean square as printed, which is what the article describes; "
        f"{shares('linear')} by its equations and {shares('exact')} for the exact cable. It holds for the "
        f"axial mode at 0.193 Hz ({near('linear', 0.18):.2f} at 0.18 Hz, {near('linear', 0.21):.2f} at "
        "0.21 Hz) and fails at the modes that move mostly across: "
        f"{near('linear', 0.13):.2f} at 0.13 Hz on the first, "
        f"{near('linear', 0.26):.2f} at 0.26 Hz on the third, no more than away from all of them "
        f"({near('linear', 0.30):.2f} at 0.30 Hz). What looks like travelling is the front of the start, "
        "which a cable without loss keeps for ever."
    )


def _lossless(sweep: Sweep) -> str:
    ratios = [
        waves.energy_ratio
        for run in sweep.of_case("article")
        if run.is_settled and (waves := run.order(0.0)) is not None
    ]
    return (
        "**Without loss the waves stand at every frequency.** A fixed top sends all back, and the linear "
        "closed form is real: its energy ratio is 1 everywhere. In the exact cable the axial energy ratio at "
        f"the bottom is {min(ratios):.3f} to {max(ratios):.3f} over the {len(ratios)} drives that settle; "
        f"the other {len(sweep.of_case('article')) - len(ratios)}, beside natural frequencies, still take "
        "energy in or give it back. Distance from resonance sets how large the waves are, not whether they "
        "travel."
    )


def _air(sweep: Sweep) -> str:
    near, away = _ratios(sweep, "air")
    least = min(sweep.of_case("air"), key=_bottom_ratio)
    return (
        "**With air drag it is the other way round.** Away from natural frequencies (by more than "
        f"{AWAY:.0%}) the axial energy ratio at the bottom is {near_text(away)}: standing. Within "
        f"{NEAR:.0%} of one it is {near_text(near)}, least {_bottom_ratio(least):.2f} at "
        f"{least.frequency:.2f} Hz "
        f"({least.work:.1f} W): there the motion across the cable is large, its drag takes the "
        "energy, and the waves along the cable must bring it. Travelling waves lead (below one third) at "
        f"{_list([run for run in sweep.of_case('air') if _bottom_ratio(run) < 1.0 / 3.0])} Hz."
    )


def _ratios(sweep: Sweep, case: str) -> tuple[list[float], list[float]]:
    near, away = [], []
    for run in sweep.of_case(case):
        distance = sweep.natural_near(run.frequency)
        if distance <= NEAR:
            near.append(_bottom_ratio(run))
        elif distance > AWAY:
            away.append(_bottom_ratio(run))
    return near, away


def _bottom_ratio(run: SettledRun) -> float:
    waves = run.order(0.0)
    return np.inf if waves is None else waves.energy_ratio


def near_text(ratios: Sequence[float]) -> str:
    """Return a range of ratios in words."""
    return f"{min(ratios):.2f} to {max(ratios):.2f} (median {float(np.median(ratios)):.2f})"


def _top(sweep: Sweep) -> str:
    _, held = _ratios(sweep, "held")
    _, matched = _ratios(sweep, "matched")
    run = next(one for one in sweep.of_case("matched") if one.frequency == 0.18)
    return (
        "**What decides is the top.** A body held as on the 150 m prototype changes little (away from "
        f"natural frequencies {near_text(held)}). A top that yields by the cable's own impedance, 2 N s/m, "
        f"returns next to nothing, there {near_text(matched)}; at 0.18 Hz the drive does {run.work:.3f} "
        f"W and {run.arriving:.3f} W leave through the top. On a straight cable whose top resists by R, "
        "travelling "
        "waves lead for R between 0.27 and 3.7 Z, whatever the frequency: |r|^2 < 1/3 with "
        "r = (R - Z)/(R + Z)."
    )
