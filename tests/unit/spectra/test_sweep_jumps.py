"""Jumps against smooth resonances, sweeps up and down, hysteresis."""

from __future__ import annotations

import numpy as np
import pytest

from tethertest.records.across import Direction, Judgement, StepVerdict
from tethertest.spectra.curve_branches import branches, judge_loop, merged
from tethertest.spectra.curve_steps import SHARE, judge_steps

FloatArray = np.ndarray


def duffing(
    frequency: FloatArray, damping: float, stiffening: float, force: float, *, up: bool
) -> FloatArray:
    """Return steady amplitudes of x'' + 2 d x' + x + b x^3 = F cos wt, one harmonic, swept one way."""
    bend, found = 0.75 * stiffening, []
    for w in frequency:
        apart = 1.0 - w * w
        squares = np.roots([bend**2, 2.0 * bend * apart, apart**2 + (2.0 * damping * w) ** 2, -(force**2)])
        real = squares.real[(np.abs(squares.imag) < 1e-7 * np.max(np.abs(squares))) & (squares.real > 0.0)]
        found.append(np.sqrt(real.max() if up else real.min()))
    return np.array(found)


def fold(low: float, high: float, *physics: float, up: bool) -> float:
    """Return the frequency at which a sweep jumps."""
    grid = np.linspace(low, high, 800)
    steps = np.abs(np.diff(np.log(duffing(grid, *physics, up=up))))
    return float(grid[:-1][np.argmax(steps)])


def seen(amplitude: FloatArray, error: float, random: np.random.Generator) -> FloatArray:
    """Return amplitudes as lines in noise show them, de-biased."""
    shown = np.hypot(
        amplitude + error * random.standard_normal(amplitude.size),
        error * random.standard_normal(amplitude.size),
    )
    return np.sqrt(np.maximum(shown**2 - error**2, 0.0))


def jumps(judgement: Judgement) -> list[tuple[float, float]]:
    return [step.interval for step in judgement.steps if step.verdict is StepVerdict.JUMP]


def resonances(x: FloatArray, random: np.random.Generator) -> FloatArray:
    """Return the magnitude of one to three modes of either sign, often with an antiresonance."""
    count = random.integers(1, 4)
    at = random.uniform(x[0] - 0.2, x[-1] + 0.2, count)
    damping, gain = 10.0 ** random.uniform(-3, -0.5, count), 10.0 ** random.uniform(-1, 0.3, count)
    sign = random.choice([-1.0, 1.0], count)
    modes = (sign * gain * at**2)[:, None] / (at[:, None] ** 2 - x**2 + 2j * (damping * at)[:, None] * x)
    found: FloatArray = np.abs(modes.sum(axis=0) + random.choice([0.0, 1.0]))
    return found


def test_a_known_jump_lies_in_the_interval() -> None:
    random = np.random.default_rng(5)
    found = held = named = sweeps = 0
    for _ in range(40):
        damping, size, stiffening = (
            random.uniform(0.01, 0.04),
            random.uniform(0.8, 1.2),
            random.uniform(0.3, 0.9),
        )
        physics = damping, stiffening, 2.0 * damping * size
        high = 1.25 + 0.375 * stiffening * size**2
        jump = fold(0.8, high, *physics, up=True)
        x = np.linspace(0.8, high, int(random.integers(20, 41)))
        x += random.uniform(-0.15, 0.15, x.size) * (x[1] - x[0])
        error = size * 10.0 ** random.uniform(-4, -2)
        judged = judge_steps(
            x, seen(duffing(x, *physics, up=True), error, random), np.full(x.size, error), 0.01
        )
        intervals = jumps(judged)
        sweeps += 1
        found += bool(intervals)
        held += bool(intervals) and all(low <= jump <= high for low, high in intervals)
        named += any(step.interval[0] <= jump <= step.interval[1] for step in judged.steps)
    assert held >= 0.95 * found
    assert found >= 0.9 * sweeps  # the others are named as undecided
    assert named >= 0.95 * sweeps


def test_a_sweep_down_finds_the_other_fold() -> None:
    physics = 0.02, 0.9, 0.05
    x = np.linspace(0.8, 1.5, 36)
    error = np.full(x.size, 1e-3)
    for up in (True, False):
        jump = fold(0.8, 1.5, *physics, up=up)
        order = slice(None) if up else slice(None, None, -1)
        judged = judge_steps(x[order], duffing(x, *physics, up=up)[order], error, 0.01)
        ((low, high),) = jumps(judged)
        assert low <= jump <= high
        assert high - low == pytest.approx(0.02)


def test_smooth_curves_of_many_modes_give_false_jumps_below_the_stated_rate() -> None:
    random = np.random.default_rng(6)
    false, curves, stated = 0, 250, 0.05
    for _ in range(curves):
        count, low = int(random.integers(6, 41)), random.uniform(0.3, 0.8)
        x = np.linspace(low, low + random.uniform(0.3, 1.5), count)
        smooth = resonances(x, random)
        error = smooth.max() * 10.0 ** random.uniform(-4, -1.3)
        false += bool(jumps(judge_steps(x, seen(smooth, error, random), np.full(count, error), stated)))
    assert false <= stated * curves


@pytest.mark.verify
def test_false_jumps_of_flat_and_resonant_curves_many_times() -> None:
    random = np.random.default_rng(7)
    for stated, flat in ((0.01, False), (0.05, False), (0.05, True)):
        false, curves = 0, 3000
        for _ in range(curves):
            count, low = int(random.integers(6, 41)), random.uniform(0.3, 0.8)
            x = np.linspace(low, low + random.uniform(0.3, 1.5), count)
            smooth = np.ones(count) if flat else resonances(x, random)
            error = smooth.max() * 10.0 ** random.uniform(-4, -1.3)
            # what a run repeats no better than is not in the errors of its lines
            smooth = smooth * (1.0 + 10.0 ** random.uniform(-4, -1.5) * random.standard_normal(count))
            false += bool(jumps(judge_steps(x, seen(smooth, error, random), np.full(count, error), stated)))
        assert false <= stated * curves


@pytest.mark.parametrize("width", [0.0, 0.05, 0.3, 1.0, 3.0])
def test_a_peak_however_narrow_is_no_jump(width: float) -> None:
    error = np.full(17, 1e-9)
    for offset in np.linspace(-0.5, 0.5, 101):
        x = np.arange(-8.0, 9.0) + offset
        peak = 1.0 / np.sqrt(x**2 + width**2 + 1e-9)
        judged = judge_steps(x, peak, error, 0.05)
        assert jumps(judged) == []
        assert all(step.excess < SHARE for step in judged.steps)


def test_an_onset_like_a_root_is_no_jump_and_a_sudden_one_is() -> None:
    x, error = np.linspace(1.0, 2.0, 21), np.full(21, 0.002)
    root = np.sqrt(np.maximum(x - 1.47, 0.0))
    sudden = np.where(x > 1.47, 0.5 + root, 0.0)
    assert jumps(judge_steps(x, root, error, 0.01)) == []
    ((low, high),) = jumps(judge_steps(x, sudden, error, 0.01))
    assert [low, high] == pytest.approx([1.45, 1.5])


def test_one_setting_halfway_is_undecided_over_both_gaps() -> None:
    x = np.arange(12.0)
    level = np.where(x < 6, 1.0, 3.0) + 0.01 * x
    level[6] = 2.0
    (step,) = judge_steps(x, level, np.full(12, 1e-3), 0.01).steps
    assert step.verdict is StepVerdict.UNDECIDED
    assert step.interval == (5.0, 7.0)


def test_a_jump_smaller_than_the_scatter_is_none() -> None:
    random = np.random.default_rng(8)
    x = np.arange(30.0)
    level = np.where(x < 15, 1.0, 1.1)
    assert jumps(judge_steps(x, level, np.full(30, 1e-4), 0.01)) == [(14.0, 15.0)]
    scattered = judge_steps(x, level * (1.0 + 0.05 * random.standard_normal(30)), np.full(30, 1e-4), 0.01)
    assert jumps(scattered) == []
    assert scattered.scatter == pytest.approx(0.05, rel=0.4)
    false = 0
    for _ in range(100):
        flat = 1.0 + 0.05 * random.standard_normal(30)
        false += bool(jumps(judge_steps(x, flat, np.full(30, 1e-4), 0.05)))
    assert false <= 0.05 * 100


def test_too_few_settings_are_refused_in_words() -> None:
    few = judge_steps(np.arange(4.0), np.ones(4), np.ones(4), 0.01)
    assert few.steps == ()
    assert "4 settings" in few.refused
    with pytest.raises(ValueError, match="rise or fall"):
        judge_steps(np.array([1.0, 2.0, 2.0, 3.0, 4.0, 5.0]), np.ones(6), np.ones(6), 0.01)


def test_sweeps_are_told_apart_by_the_order_in_time() -> None:
    there_and_back = np.array([0.1, 0.2, 0.3, 0.3, 0.4, 0.5, 0.4, 0.3, 0.2])
    up, down = branches(there_and_back)
    assert (up.direction, up.members) == (Direction.UP, (0, 1, 2, 3, 4, 5))
    assert (down.direction, down.members) == (Direction.DOWN, (5, 6, 7, 8))
    (mixed,) = branches(np.array([0.3, 0.1, 0.4, 0.2, 0.5]))
    assert mixed.direction is Direction.UNORDERED
    assert mixed.members == (0, 1, 2, 3, 4)
    up, rest = branches(np.array([0.1, 0.2, 0.3, 0.33, 0.3, 0.3, 0.33]))
    assert (up.members, rest.members) == ((0, 1, 2, 3), (4, 5, 6))
    assert branches(np.array([])) == ()


def test_repeats_become_one_setting_with_the_spread_they_show() -> None:
    setting, amplitude, error = merged(
        np.array([2.0, 1.0, 2.001, 3.0]), np.array([5.0, 1.0, 7.0, 9.0]), np.array([0.1, 0.1, 0.1, 0.1])
    )
    np.testing.assert_allclose(setting, [1.0, 2.0005, 3.0])
    np.testing.assert_allclose(amplitude, [1.0, 6.0, 9.0])
    np.testing.assert_allclose(error, [0.1, 1.0, 0.1])


def test_hysteresis_is_found_between_the_folds_and_its_area_is_right() -> None:
    physics = 0.02, 0.6, 0.04
    random = np.random.default_rng(9)
    x = np.linspace(0.8, 1.5, 36)
    error = 0.005
    sweeps = [seen(duffing(x, *physics, up=up), error, random) for up in (True, False)]
    errors = np.full(x.size, error)
    steps = [step for y in sweeps for step in judge_steps(x, y, errors, 0.01).steps]
    loop = judge_loop((x, sweeps[0], errors), (x, sweeps[1], errors), 0.01, steps)
    assert loop is not None
    assert loop.differs is not None
    first, last = fold(0.8, 1.5, *physics, up=False), fold(0.8, 1.5, *physics, up=True)
    assert loop.differs[0] == pytest.approx(first, abs=0.02)
    assert loop.differs[1] == pytest.approx(last, abs=0.02)
    fine = np.linspace(0.8, 1.5, 3000)
    exact = np.trapezoid(duffing(fine, *physics, up=True) - duffing(fine, *physics, up=False), fine)
    assert loop.interval[0] <= exact <= loop.interval[1]
    assert loop.interval[0] > 0.0


def test_equal_sweeps_have_no_hysteresis_at_the_stated_rate() -> None:
    random = np.random.default_rng(10)
    x = np.linspace(1.0, 2.0, 12)
    level, errors, called = 1.0 + x, np.full(12, 0.01), 0
    areas = []
    for _ in range(400):
        up, down = (level + 0.01 * random.standard_normal(12) for _ in range(2))
        loop = judge_loop((x, up, errors), (x, down, errors), 0.05)
        assert loop is not None
        called += loop.found
        areas.append(loop.interval[0] <= 0.0 <= loop.interval[1])
    assert called <= 0.075 * 400
    assert np.mean(areas) == pytest.approx(0.95, abs=0.035)
    assert judge_loop((x, level, errors), (x + 3.0, level, errors), 0.05) is None
    nothing = merged(np.empty(0), np.empty(0), np.empty(0))
    assert judge_loop((x, level, errors), nothing, 0.05) is None
