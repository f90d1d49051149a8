"""Two noisy records of one waveform: offset, drift, their standard errors, and which cycle."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from tethertest.conditioning.clocks.alignment import AlignmentSignals, ClockAlignment, fitted
from tethertest.conditioning.clocks.band import best_cutoff
from tethertest.conditioning.clocks.clock_linearity import delays, worst
from tethertest.conditioning.clocks.correlation import scanned
from tethertest.conditioning.clocks.cycle_ambiguity import chosen
from tethertest.conditioning.clocks.folding import without_folding
from tethertest.conditioning.clocks.uniform import Signal, uniform, worn
from tethertest.records.channel import Channel

PRIOR = 1e-4 / np.sqrt(3.0)
FREQUENCY, LENGTH, NOISE = 0.5, 60.0, 0.02
OFFSET, DRIFT = 1.3, 4e-5
SPANS = tuple((start, start + 8.0) for start in np.arange(2.0, 58.0, 8.0))


def driven(time: np.ndarray, start: float = 8.0, ramp: float = 3.0) -> np.ndarray:
    """Return a drive that starts from rest; with a start long before the record it is steady."""
    turned = np.where(time < start, 0.0, np.clip(time - start, 0.0, ramp) ** 2 / (2.0 * ramp))
    turned = turned + np.clip(time - start - ramp, 0.0, None)
    return np.cos(2.0 * np.pi * FREQUENCY * turned)


def pair(
    seed: int, *, rates=(200.0, 50.0), start: float = 8.0, jump: float = 0.0, noise=NOISE
) -> AlignmentSignals:
    random = np.random.default_rng(seed)
    signals = []
    for rate, (offset, drift) in zip(rates, ((0.0, 0.0), (OFFSET, DRIFT)), strict=True):
        true = np.arange(0.1, LENGTH, 1.0 / rate)
        values = driven(true, start) + noise * random.standard_normal(true.size)
        time = offset + (1.0 + drift) * true
        if offset:
            time = time + jump * (true > 35.0)
        signals.append(uniform(Channel("s", "tension", "N", time, values, np.zeros(true.size, np.uint16))))
    return AlignmentSignals(signals[0], signals[1])


def comparison(records: AlignmentSignals, cutoff: float) -> ClockAlignment:
    return ClockAlignment(records.low_passed(cutoff), SPANS, 0.03, cutoff, 0.0)


def found(records: AlignmentSignals):
    cutoff = best_cutoff(records, FREQUENCY)
    compared = comparison(records, cutoff)
    scan = scanned(compared, records.low_passed(cutoff), 1e-4, 0.03, cutoff)
    return compared, chosen(compared, scan.candidates(8), PRIOR, cutoff)


@pytest.mark.parametrize("rates", [(200.0, 50.0), (40.0, 300.0)])
def test_errors_scatter_as_stated(rates):
    """Root mean square of error over standard error is 1, whichever record is the slower."""
    scores = []
    for seed in range(25):
        line = fitted(comparison(pair(seed, rates=rates), 4.0), (OFFSET, DRIFT), PRIOR, 4.0)
        error = np.array([line.offset - OFFSET, line.drift - DRIFT])
        scores.append(error / np.sqrt(np.diag(line.covariance)))
    spread = np.sqrt(np.mean(np.square(scores), axis=0))
    np.testing.assert_allclose(spread, 1.0, atol=0.35)


def test_standard_error_is_that_of_the_bound():
    """White noise of both records at frequency f: ``sigma^2 = n / (integral of the slope's square)``."""
    line = fitted(comparison(pair(3), 4.0), (OFFSET, DRIFT), 1e-9, 4.0)
    density = NOISE**2 * (1.0 / 200.0 + 1.0 / 50.0)
    energy = 0.5 * (2.0 * np.pi * FREQUENCY) ** 2 * (LENGTH - 10.0)
    assert np.sqrt(line.covariance[0, 0]) == pytest.approx(np.sqrt(density / energy), rel=0.15)


def test_what_the_rig_does_not_know_widens_the_offset_by_the_delay_it_makes():
    """A change that is the delay of 5 ms itself adds 5 ms."""
    records = pair(3).low_passed(4.0)
    clock = records.clock
    late = -5e-3 * np.gradient(clock.values, clock.step)
    plain = fitted(ClockAlignment(records, SPANS, 0.03, 4.0, 0.0), (OFFSET, DRIFT), PRIOR, 4.0)
    unsure = fitted(
        ClockAlignment(AlignmentSignals(records.reference, clock, (late,)), SPANS, 0.03, 4.0, 0.0),
        (OFFSET, DRIFT),
        PRIOR,
        4.0,
    )
    added = np.sqrt(unsure.covariance[0, 0] - plain.covariance[0, 0])
    assert added == pytest.approx(5e-3, rel=0.03)
    assert unsure.offset == plain.offset


def test_a_start_chooses_the_cycle():
    _, (line, rivals) = found(pair(5))
    assert rivals == ()
    assert line.offset == pytest.approx(OFFSET, abs=2e-3)
    assert line.drift == pytest.approx(DRIFT, abs=5e-5)


@pytest.mark.parametrize("noise", [0.1 * NOISE, NOISE, 10.0 * NOISE])
def test_a_steady_drive_chooses_none(noise):
    """However little noise there is: offsets a period apart fit alike."""
    _, (line, rivals) = found(pair(5, start=-100.0, noise=noise))
    assert rivals
    nearest = min(abs(item.offset - line.offset) for item in rivals)
    assert nearest == pytest.approx(1.0 / FREQUENCY, abs=0.02)


def test_a_clock_that_jumps_by_20_ms_does_not_run_straight():
    compared, (line, _) = found(pair(5, jump=0.02))
    left = worst(delays(compared, line))
    assert left is not None
    assert abs(left.delay) > 5e-3
    compared, (line, _) = found(pair(5))
    assert worst(delays(compared, line)) is None


def test_drift_is_found_from_a_start_that_knows_none():
    """100 ppm over ten minutes part the ends by 60 ms, a quarter of a period of the band."""
    random = np.random.default_rng(1)
    true = np.arange(0.0, 600.0, 0.02)
    flags = np.zeros(true.size, np.uint16)
    noisy = [driven(true) + NOISE * random.standard_normal(true.size) for _ in range(2)]
    clock = uniform(Channel("c", "tension", "N", 1.0001 * true - 2.0, noisy[1], flags))
    records = AlignmentSignals(uniform(Channel("r", "tension", "N", true, noisy[0], flags)), clock)
    compared = ClockAlignment(records.low_passed(4.0), ((0.0, 590.0),), 0.03, 4.0, 0.0)
    offset, drift = scanned(compared, records.low_passed(4.0), 1e-4, 0.03, 4.0).candidates(1)[0]
    assert (offset, drift) == pytest.approx((-2.0, 1e-4), abs=0.02)
    assert drift == pytest.approx(1e-4, abs=3e-5)


def test_samples_near_a_hole_are_not_compared():
    time = np.arange(0.0, 20.0, 0.01)
    keep = (time < 8.0) | (time > 9.0)
    signal = uniform(
        Channel("s", "tension", "N", time[keep], driven(time[keep]), np.zeros(keep.sum(), np.uint16))
    )
    slow = signal.low_passed(2.0)
    assert isinstance(slow, Signal)
    inside = slow.time[~slow.usable & (slow.time > 2.0) & (slow.time < 18.0)]
    assert inside.min() == pytest.approx(7.5, abs=0.06)
    assert inside.max() == pytest.approx(9.5, abs=0.06)
    true = driven(slow.time) - np.median(driven(time))
    np.testing.assert_allclose(slow.values[slow.usable][20:-20], true[slow.usable][20:-20], atol=0.06)


def test_a_low_pass_wears_the_ends_of_a_record_and_the_sides_of_its_holes():
    """The filter bends within a period of what it cannot see; a single bad sample it bridges."""
    usable = np.ones(1000, dtype=bool)
    usable[300:400] = usable[700] = False
    kept = worn(usable, 100.0, 2.0)
    reach = 51
    spans = np.flatnonzero(np.diff(np.concatenate(([False], kept, [False])).astype(int)))
    assert spans.tolist() == [reach, 300 - reach, 400 + reach, 697, 704, 1000 - reach]


def test_the_ends_of_a_filtered_record_show_no_delay():
    """Noise of 0.1 bends the first filtered sample by several times what it leaves inside."""
    left = []
    for seed in range(10):
        records = pair(seed, noise=0.1)
        compared = comparison(records, 4.0)
        line = fitted(compared, (OFFSET, DRIFT), PRIOR, 4.0)
        known = np.flatnonzero(line.use)
        inside = np.std(line.residual[known[20:-20]])
        left += [np.max(np.abs(line.residual[known[end]])) / inside for end in (slice(0, 3), slice(-3, None))]
    assert np.max(left) < 4.0


def knocked(rate: float) -> Signal:
    """Return a drive with two knocks at rest, each with the UAV bouncing at 14 Hz behind it."""
    time = np.arange(0.0, LENGTH, 1.0 / rate)
    values = driven(time) + NOISE * np.random.default_rng(3).standard_normal(time.size)
    for when in (3.0, 4.0):
        later = np.clip(time - when, 0.0, None)
        values += 2.0 * np.sin(2.0 * np.pi * 14.0 * later) * np.exp(-4.0 * later)
    return uniform(Channel("s", "tension", "N", time, values, np.zeros(time.size, np.uint16)))


@pytest.mark.parametrize("slower", ["reference", "clock"])
def test_knocks_that_one_record_folds_are_not_compared(slower):
    fast, slow = knocked(400.0), knocked(25.0)
    pair = without_folding(
        AlignmentSignals(slow, fast) if slower == "reference" else AlignmentSignals(fast, slow)
    )
    kept = pair.clock if slower == "reference" else pair.reference
    left = kept.time[~kept.usable & (kept.time > 0.5) & (kept.time < LENGTH - 0.5)]
    assert 2.8 < left.min() < 3.0
    assert 4.5 < left.max() < 5.5
    assert np.mean(kept.usable) > 0.95
    other = pair.reference if slower == "reference" else pair.clock
    np.testing.assert_array_equal(other.usable, slow.usable)


def test_nothing_is_taken_from_records_that_follow_the_knocks():
    pair = AlignmentSignals(knocked(400.0), knocked(100.0))
    assert without_folding(pair) is pair


def test_a_timing_error_of_each_span_averages_over_the_spans():
    """Seven spans of steady drive with 10 ms each: 10 ms / sqrt(7) where the drift is known."""
    records = pair(3, start=-100.0).low_passed(4.0)
    sure, unsure = (
        fitted(ClockAlignment(records, SPANS, 0.0, 4.0, systematic), (OFFSET, DRIFT), 1e-9, 4.0)
        for systematic in (0.0, 0.01)
    )
    added = np.sqrt(unsure.covariance[0, 0] - sure.covariance[0, 0])
    assert added == pytest.approx(0.01 / np.sqrt(len(SPANS)), rel=0.05)
    assert unsure.offset == pytest.approx(sure.offset, abs=1e-6)


def test_what_is_slow_in_one_record_only_moves_no_offset():
    records = pair(3).low_passed(4.0)
    time = records.clock.time
    warming = 0.8 * np.cos(np.pi * (time - time[0]) / (time[-1] - time[0])) + 0.02 * (time - 30.0)
    warmed = AlignmentSignals(
        records.reference, replace(records.clock, values=records.clock.values + warming)
    )
    plain, bent = (
        fitted(ClockAlignment(item, SPANS, 0.03, 4.0, 0.0), (OFFSET, DRIFT), PRIOR, 4.0)
        for item in (records, warmed)
    )
    assert bent.offset == pytest.approx(plain.offset, abs=2e-4)
    assert bent.explained == pytest.approx(plain.explained, abs=0.2)
    # where only spans are compared each has a level of its own
    stairs = 3.0 * np.searchsorted([stop for _, stop in SPANS], time)
    stepped = AlignmentSignals(
        records.reference, replace(records.clock, values=records.clock.values + stairs)
    )
    plain, bent = (
        fitted(ClockAlignment(item, SPANS, 0.0, 4.0, 0.0), (OFFSET, DRIFT), PRIOR, 4.0)
        for item in (records, stepped)
    )
    assert bent.offset == pytest.approx(plain.offset, abs=1e-4)


@pytest.mark.parametrize("rates", [(200.0, 50.0), (40.0, 300.0)])
def test_the_gain_is_that_of_the_reference_over_the_clock(rates):
    records = pair(3, rates=rates).low_passed(4.0)
    doubled = AlignmentSignals(
        replace(records.reference, values=2.0 * records.reference.values), records.clock
    )
    line = fitted(ClockAlignment(doubled, SPANS, 0.03, 4.0, 0.0), (OFFSET, DRIFT), PRIOR, 4.0)
    assert line.gain == pytest.approx(2.0, rel=0.01)
    assert line.explained > 0.99


def test_each_span_says_how_late_it_is_and_how_sure():
    """20 ms from 35 s on: about the line fitted the delays part by as much."""
    compared, (line, _) = found(pair(5, jump=0.02))
    left = delays(compared, line)
    # whatever the line takes of it, early and late spans part by 20 ms less the drift between them
    fitted_there = line.offset + line.drift * (np.array([item.time for item in left]) - OFFSET)
    true = (
        OFFSET
        + DRIFT * np.array([item.time for item in left])
        + 0.02 * (np.array([item.time for item in left]) > 35.0 + OFFSET)
    )
    clean = [abs(item.time - 36.3) > 4.0 for item in left]
    missing = np.array([item.delay for item in left]) - (true - fitted_there)
    assert np.max(np.abs(missing[clean])) < 1.5e-3
    density = NOISE**2 * (1.0 / 200.0 + 1.0 / 50.0)
    bound = np.sqrt(density / (0.5 * (2.0 * np.pi * FREQUENCY) ** 2 * 8.0))
    compared, (line, _) = found(pair(5))
    errors = [item.error for item in delays(compared, line)]
    assert np.median(errors) == pytest.approx(bound, rel=0.3)


def test_rivals_that_fit_alike_differ_by_less_than_a_standard_deviation():
    """The variance is an upper bound: offsets a period apart scatter by half of its root."""
    sigmas = [item.sigmas for seed in range(6) for item in found(pair(seed, start=-100.0))[1][1]]
    assert len(sigmas) > 30
    assert np.sqrt(np.mean(np.square(sigmas))) == pytest.approx(0.5, abs=0.15)


def test_a_span_that_knows_its_delay_to_twenty_milliseconds_only_says_nothing():
    for noise, every in ((0.4, True), (4.0, False)):
        compared = comparison(pair(5, noise=noise, start=-100.0), 4.0)
        line = fitted(compared, (OFFSET, DRIFT), PRIOR, 4.0)
        told = delays(compared, line)
        assert (len(told) == len(SPANS)) is every
        assert all(item.error < 0.02 for item in told)


def test_the_first_sample_of_an_uneven_record_counts_as_any_other():
    random = np.random.default_rng(1)
    time = (np.arange(3000) + random.uniform(-0.2, 0.2, 3000)) / 30.0
    values = np.where(np.arange(3000) == 0, 1.0, 0.0)
    none = np.zeros(3000, np.uint16)
    raised, plain = (
        uniform(Channel("s", "tension", "N", time, item, none)) for item in (values, 0.0 * values)
    )
    apart = np.abs(raised.values - plain.values)
    assert np.max(apart[plain.usable]) > 0.003
    assert np.argmax(apart) == 0
