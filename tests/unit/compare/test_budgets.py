"""Every term of a metric's uncertainty, alone and together, against its closed form."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from tethertest.compare.metrics import order_metrics, peak_metric, sprague_geers_metrics
from tethertest.compare.subject import Subject, undecided
from tethertest.records.comparison import Metric, Verdict
from tethertest.records.lines import LineVerdict
from tethertest.records.rig import Limits

from .subjects import DRIVE, channel, cosine, line, lines, pair, subject


def named(metrics: list[Metric], name: str) -> Metric:
    return next(item for item in metrics if item.name == name)


def test_input_uncertainty_is_the_root_sum_of_squares_of_the_changes_from_the_nominal_replay() -> None:
    plain = subject()
    assert plain.input_uncertainty([1.0, 1.3, 0.6]) == pytest.approx(0.5)
    assert plain.input_uncertainty([1.0, 1.3, 1.3, 1.3, 1.3]) == pytest.approx(0.6)
    assert plain.input_uncertainty([1.0]) == 0.0
    assert plain.input_uncertainty([]) == 0.0


def test_a_budget_tells_data_inputs_and_mesh_apart() -> None:
    found = subject().budget(0.1, 1.02, [1.0, 1.3, 0.6])
    assert (found.data, found.inputs, found.numerical) == pytest.approx((0.1, 0.5, 0.02))
    assert subject().budget(0.1, 0.97, [1.0]).numerical == pytest.approx(0.03)
    assert subject().budget(0.1, 5.0, []).numerical == 0.0


def test_what_nobody_knows_of_a_slack_cable_is_the_widened_root_mean_square_of_its_members() -> None:
    found = subject().budget(0.03, 1.0, [1.0], [2.0, 2.3, 1.6])
    # Student's 2.920 of two degrees of freedom over the guard band's 1.645
    assert found.slack == pytest.approx(np.sqrt((0.3**2 + 0.4**2) / 2.0) * 2.920 / 1.645, rel=1e-3)
    assert found.total == pytest.approx(np.hypot(0.03, found.slack))
    assert subject().budget(0.03, 1.0, [1.0], [2.0]).slack == 0.0
    assert subject().budget(0.03, 1.0, [1.0]).slack == 0.0


def test_every_metric_takes_the_members_of_a_slack_cable_into_its_budget() -> None:
    """Members 4 % larger than their nominal: nothing else is uncertain."""
    measured = line("1", 2.0)
    own, larger = channel(cosine(2.0)), channel(cosine(2.08))
    taut = subject(
        measured=own,
        replayed=own,
        pair=pair(own.values, own.values, measured_peak=10.0, replayed_peak=10.0),
        measured_lines=lines(measured),
        replayed_lines=lines(measured),
        static=0.0,
    )
    slack = replace(
        taut,
        members=(own, larger),
        member_pairs=(taut.pair, replace(taut.pair, replayed=larger.values, replayed_peak=10.4)),
    )
    for name, metrics in (
        ("peak_tension", lambda item: [peak_metric(item)]),
        ("order_amplitude 1", order_metrics),
        ("sprague_geers", sprague_geers_metrics),
    ):
        assert named(metrics(taut), name).uncertainty == pytest.approx(0.0, abs=1e-6)
        found = named(metrics(slack), name)
        assert found.uncertainty == pytest.approx(0.04 * 6.314 / 1.645, rel=0.02)
        assert "slack 15 %" in found.reason


def test_a_metric_has_the_total_uncertainty_and_its_note() -> None:
    budget = subject().budget(0.02, 1.0, [1.01, 1.03, 1.01])
    held = subject(limits=Limits(decision="simple"))
    found = held.metric("m", "1", 1.0, 2.0, 0.07, budget, 0.1, "by hand")
    assert found.uncertainty == pytest.approx(0.03)  # 0.02, 0.02 and 0.01
    assert (found.name, found.channel, found.measured, found.replayed) == ("m", "tension_top", 1.0, 2.0)
    assert (found.limit, found.verdict) == (0.1, Verdict.PASS)
    assert found.reason.endswith("inside by 3 %; by hand")
    assert held.metric("m", "1", 1.0, 2.0, 0.07, budget, 0.1).reason.endswith("inside by 3 %")
    assert " rad " in held.metric("m", "rad", 1.0, 2.0, 0.07, budget, 0.1).reason
    informing = replace(held, limited=False).metric("m", "1", 1.0, 2.0, 0.07, budget, 0.1)
    assert (informing.limit, informing.verdict) == (None, Verdict.INFORMATIVE)


def test_what_could_not_be_formed_is_undecided_only_where_it_has_a_limit() -> None:
    limited, free = (undecided("m", "top", "N", limit, "lost") for limit in (0.1, None))
    assert (limited.verdict, limited.limit, limited.reason) == (Verdict.UNDECIDED, 0.1, "lost")
    assert free.verdict is Verdict.INFORMATIVE


# peak tension: replayed over measured


def peaked(**fields: object) -> Subject:
    return subject(
        pair=pair(measured_peak=10.0, replayed_peak=11.0), limits=Limits(peak_tension=0.2), **fields
    )


def test_the_peaks_error_is_relative_to_the_measured_one() -> None:
    found = peak_metric(peaked())
    assert (found.measured, found.replayed) == (10.0, 11.0)
    assert found.error == pytest.approx(0.1)
    assert (found.uncertainty, found.limit, found.unit) == (0.0, 0.2, "N")


def test_noise_of_the_peak_and_calibration_add_in_square_and_grow_with_the_ratio() -> None:
    noisy = pair(measured_peak=10.0, replayed_peak=11.0, peak_noise=0.3)
    assert peak_metric(peaked(measured=channel(0.0, uncertainty=0.04))).uncertainty == pytest.approx(0.044)
    assert peak_metric(replace(peaked(), pair=noisy)).uncertainty == pytest.approx(0.033)
    both = replace(peaked(measured=channel(0.0, uncertainty=0.04)), pair=noisy)
    assert peak_metric(both).uncertainty == pytest.approx(0.055)


def test_moved_peaks_are_held_against_the_measured_one() -> None:
    moved = tuple(pair(measured_peak=99.0, replayed_peak=peak) for peak in (11.2, 11.5, 10.8))
    found = peak_metric(peaked(moved_pairs=moved))
    assert "data 0 %, rig 5 %, numerical 2 %" in found.reason
    assert found.uncertainty == pytest.approx(np.hypot(0.05, 0.02))


# Sprague-Geers: over whole periods of m = cos, c = a cos(. - phi) it is M = a - 1, P = phi / pi

LARGER, LATE = 1.2, 0.3
MAGNITUDE, PHASE = LARGER - 1.0, LATE / np.pi
COMBINED = np.hypot(MAGNITUDE, PHASE)


def whole(**fields: object) -> Subject:
    sides = pair(5.0 + cosine(1.0), 5.0 + cosine(LARGER, -LATE))
    return subject(pair=sides, static=5.0, limits=Limits(sprague_geers=0.15), **fields)


def with_noise(noise: float, factor: float = 1.0) -> tuple[float, float]:
    """Return M and P where the noise's energy was taken off the measured one."""
    left = np.sqrt(1.0 - 2.0 * factor * noise**2)
    return LARGER / left - 1.0, float(np.arccos(np.cos(LATE) / left) / np.pi)


def test_the_three_parts_of_the_whole_signal() -> None:
    found = sprague_geers_metrics(whole())
    assert [item.name for item in found] == [
        "sprague_geers",
        "sprague_geers_magnitude",
        "sprague_geers_phase",
    ]
    assert [item.error for item in found] == pytest.approx([COMBINED, MAGNITUDE, PHASE], rel=1e-6)
    assert [item.limit for item in found] == [0.15, None, None]
    assert [item.uncertainty for item in found] == pytest.approx([0.0, 0.0, 0.0], abs=1e-12)
    assert "static 5 N removed from both, both low-passed at 30 Hz" in found[0].reason


def test_without_a_tension_at_rest_each_side_loses_its_own_mean() -> None:
    sides = pair(5.0 + cosine(1.0), 3.0 + cosine(LARGER, -LATE))
    # a tenth does not count, and neither in the means
    spoiled = np.arange(sides.time.size) < 200
    sides = replace(sides, usable=~spoiled, measured=np.where(spoiled, 70.0, sides.measured))
    found = sprague_geers_metrics(replace(whole(), static=None, pair=sides))
    assert [item.error for item in found] == pytest.approx([COMBINED, MAGNITUDE, PHASE], rel=2e-3)
    assert found[0].reason.endswith(
        "mean of each side removed, both low-passed at 30 Hz, noise energy taken off the measured"
    )


def test_noise_is_taken_off_and_a_fifth_of_it_is_doubted() -> None:
    noisy = replace(whole(), pair=replace(whole().pair, noise=0.15))
    found = sprague_geers_metrics(noisy)
    assert [item.error for item in found[1:]] == pytest.approx(with_noise(0.15), rel=1e-5)
    change = np.hypot(*with_noise(0.15, 1.2)) - np.hypot(*with_noise(0.15))
    assert [item.uncertainty for item in found] == pytest.approx([change] * 3, rel=1e-4)


def test_calibration_enters_by_the_share_of_magnitude() -> None:
    found = sprague_geers_metrics(whole(measured=channel(0.0, uncertainty=0.02)))
    assert found[0].uncertainty == pytest.approx(0.02 * LARGER * MAGNITUDE / COMBINED, rel=1e-6)


def test_the_clock_enters_by_the_share_of_phase() -> None:
    found = sprague_geers_metrics(whole(clock_error=0.03))
    # 2 pi f dt is the phase of order 1; over pi it is P
    assert found[0].uncertainty == pytest.approx(2.0 * DRIVE * 0.03 * PHASE / COMBINED, rel=1e-6)


def test_terms_of_the_whole_signal_add_in_square() -> None:
    alone = [whole(measured=channel(0.0, uncertainty=0.02)), whole(clock_error=0.03)]
    parts = [sprague_geers_metrics(item)[0].uncertainty for item in alone]
    both = whole(measured=channel(0.0, uncertainty=0.02), clock_error=0.03)
    assert sprague_geers_metrics(both)[0].uncertainty == pytest.approx(np.hypot(*parts))


def test_equal_signals_have_the_whole_uncertainty_of_scale_and_clock() -> None:
    equal = whole(measured=channel(0.0, uncertainty=0.03), clock_error=0.04)
    equal = replace(equal, pair=pair(6.0, 6.0))
    found = sprague_geers_metrics(equal)
    assert found[0].error == 0.0
    assert found[0].uncertainty == pytest.approx(np.hypot(0.03, 2.0 * DRIVE * 0.04))


def test_moved_replays_move_each_part_by_its_own() -> None:
    moved = tuple(pair(5.0 + cosine(1.0), 5.0 + cosine(scale, -LATE)) for scale in (1.22, 1.25, 1.18))
    found = sprague_geers_metrics(whole(moved_pairs=moved))
    assert "rig 5 %, numerical 2 %" in found[1].reason
    assert found[1].uncertainty == pytest.approx(np.hypot(0.05, 0.02), rel=1e-6)
    assert found[2].uncertainty == pytest.approx(0.0, abs=1e-9)
    combined = [np.hypot(scale - 1.0, PHASE) for scale in (1.22, 1.25, 1.18)]
    inputs = np.hypot(combined[1] - combined[0], combined[2] - combined[0])
    assert found[0].uncertainty == pytest.approx(np.hypot(inputs, combined[0] - COMBINED), rel=1e-6)


def test_a_signal_that_is_zero_is_undecided_where_it_has_a_limit() -> None:
    silent = replace(whole(), pair=pair(5.0 + cosine(1.0), 5.0))
    (found,) = sprague_geers_metrics(silent)
    assert (found.verdict, found.limit, found.name) == (Verdict.UNDECIDED, 0.15, "sprague_geers")
    assert "replayed signal is zero" in found.reason
    assert "static 5 N removed" in found.reason
    (informing,) = sprague_geers_metrics(replace(silent, limited=False))
    assert (informing.verdict, informing.limit) == (Verdict.INFORMATIVE, None)


# orders of the drive

HELD = Limits(order_amplitude={"1": 0.2, "3": 0.3}, order_phase={"1": 0.4})


def ordered(**fields: object) -> Subject:
    plain = subject(
        replayed=channel(5.0 + cosine(2.2, -0.3) + cosine(0.1, 0.5, 3.0)),
        measured_lines=lines(line("1", 2.0, 0.1), line("2", 0.5), line("3", 0.1, 0.5)),
        replayed_lines=lines(line("1", 2.2, -0.3), line("2", 0.5), line("3", 0.1, 0.5)),
        limits=HELD,
    )
    return replace(plain, **fields)


def test_errors_of_an_order_without_any_doubt() -> None:
    found = order_metrics(ordered())
    assert [item.name for item in found] == [
        "order_amplitude 1",
        "order_phase 1",
        "order_amplitude 2",
        "order_amplitude 3",
    ]
    amplitude, phase = found[:2]
    assert amplitude.error == pytest.approx(0.1)
    assert (amplitude.measured, amplitude.replayed, amplitude.unit, amplitude.limit) == (2.0, 2.2, "N", 0.2)
    assert phase.error == pytest.approx(-0.4)
    assert (phase.measured, phase.replayed, phase.unit, phase.limit) == (0.1, -0.3, "rad", 0.4)
    assert [item.uncertainty for item in found[:2]] == pytest.approx([0.0, 0.0], abs=1e-9)


def test_the_amplitudes_data_are_both_lines_and_the_scale() -> None:
    found = order_metrics(
        ordered(
            measured=channel(0.0, uncertainty=0.04),
            measured_lines=lines(line("1", 2.0, standard_error=0.06)),
            replayed_lines=lines(line("1", 2.2, standard_error=0.05)),
        )
    )
    # 1.1 hypot(0.06 / 2, 0.04) = 0.055, and 0.05 / 2 of the replay's own line
    assert named(found, "order_amplitude 1").uncertainty == pytest.approx(np.hypot(0.055, 0.025), rel=1e-6)


def test_the_phases_data_are_the_measured_line_and_the_clock_at_the_orders_frequency() -> None:
    held = ordered(
        clock_error=0.02,
        measured_lines=lines(line("1", 2.0, standard_error=0.06), line("2", 0.5, standard_error=0.01)),
        limits=Limits(order_phase={"1": 0.4, "2": 0.5}),
    )
    found = order_metrics(held)
    assert named(found, "order_phase 1").uncertainty == pytest.approx(np.hypot(0.03, 2 * np.pi * 0.5 * 0.02))
    second = replace(held, replayed=channel(cosine(2.2) + cosine(0.5, 0.0, 2.0)))
    phase = named(order_metrics(second), "order_phase 2")
    assert phase.uncertainty == pytest.approx(np.hypot(0.02, 2 * np.pi * 1.0 * 0.02))
    assert phase.limit == 0.5


def test_a_phase_is_at_most_half_a_turn_uncertain() -> None:
    found = order_metrics(ordered(measured_lines=lines(line("1", 0.0, standard_error=0.06))))
    assert named(found, "order_phase 1").uncertainty == pytest.approx(np.pi)


def test_moved_replays_move_amplitude_and_phase() -> None:
    moved = [(2.24, 3.10), (2.30, 3.13), (2.16, 3.14)]  # nominal on the coarser mesh, then two parameters
    found = order_metrics(
        ordered(
            replayed=channel(cosine(2.2, -3.08)),
            replayed_lines=lines(line("1", 2.2, -3.08)),
            moved=tuple(channel(cosine(*item)) for item in moved),
        )
    )
    assert named(found, "order_amplitude 1").uncertainty == pytest.approx(np.hypot(0.05, 0.02), rel=1e-5)
    # from -3.08 to 3.10 is 0.103 the short way round
    numerical, inputs = 2 * np.pi - 6.18, np.hypot(0.03, 0.04)
    assert named(found, "order_phase 1").uncertainty == pytest.approx(np.hypot(numerical, inputs), rel=1e-5)


def test_an_amplitude_debiased_to_nothing_is_held_against_its_standard_error() -> None:
    found = order_metrics(ordered(measured_lines=lines(line("1", 0.02, standard_error=0.4))))
    assert named(found, "order_amplitude 1").error == pytest.approx(2.2 / 0.4 - 1.0)


@pytest.mark.parametrize(
    ("replayed", "verdict", "limit"),
    [
        (0.003, Verdict.INFORMATIVE, None),  # below a tenth of the standard error: on neither side
        (0.004, Verdict.UNDECIDED, 0.3),
        (0.08, Verdict.UNDECIDED, 0.3),  # the upper end of the interval: still agrees
        (0.0801, Verdict.FAIL, 0.3),
    ],
)
def test_an_order_that_is_not_significant_is_judged_only_above_its_interval(
    replayed: float, verdict: Verdict, limit: float | None
) -> None:
    hidden = line("3", 0.0, standard_error=0.04, verdict=LineVerdict.NONE)
    found = order_metrics(
        ordered(
            measured_lines=lines(hidden),
            replayed_lines=lines(line("3", replayed)),
            limits=Limits(order_amplitude={"3": 0.3}, decision="simple"),
        )
    )
    third = named(found, "order_amplitude 3")
    assert (third.verdict, third.limit) == (verdict, limit)
    if verdict is not Verdict.FAIL:
        assert third.error == third.uncertainty == 0.0
        assert (third.measured, third.replayed) == (0.0, replayed)
    if verdict is Verdict.UNDECIDED:
        assert "its limit of 30 % cannot be judged" in third.reason


def test_an_order_that_was_not_resolved_and_has_no_amplitude_is_missing() -> None:
    unresolved = line("3", 0.0, standard_error=0.04, verdict=LineVerdict.NOT_RESOLVABLE)
    found = order_metrics(ordered(measured_lines=lines(unresolved)))
    third = named(found, "order_amplitude 3")
    assert (third.verdict, third.limit) == (Verdict.UNDECIDED, 0.3)
    assert third.reason == "order 3 was not fitted on both sides"
    assert third.unit == "N"
    seen = replace(unresolved, amplitude=0.08)
    judged = named(order_metrics(ordered(measured_lines=lines(seen))), "order_amplitude 3")
    assert judged.error == pytest.approx(0.25)


def test_orders_missing_on_either_side_are_undecided_where_limited() -> None:
    for fields in ({"measured_lines": None}, {"replayed_lines": None}, {"measured_lines": lines()}):
        found = {item.name: item for item in order_metrics(ordered(**fields))}
        assert {name: item.limit for name, item in found.items()} == {
            "order_amplitude 1": 0.2,
            "order_phase 1": 0.4,
            "order_amplitude 2": None,
            "order_amplitude 3": 0.3,
        }
        assert found["order_phase 1"].unit == "rad"
        assert found["order_phase 1"].verdict is Verdict.UNDECIDED
        assert found["order_amplitude 2"].verdict is Verdict.INFORMATIVE
    free = order_metrics(ordered(measured_lines=None, limited=False))
    assert {item.limit for item in free} == {None}


def test_orders_of_the_limits_are_compared_in_order_of_frequency() -> None:
    limits = Limits(order_amplitude={"1/2": 0.2, "10": 0.1}, order_phase={"3/2": 0.3})
    found = order_metrics(ordered(measured_lines=None, limits=limits))
    assert [item.name for item in found] == [
        "order_amplitude 1/2",
        "order_amplitude 1",
        "order_phase 1",
        "order_phase 3/2",
        "order_amplitude 2",
        "order_amplitude 3",
        "order_amplitude 10",
    ]


def test_phases_of_moved_replays_are_held_against_that_of_the_replay_itself() -> None:
    moved = tuple(channel(cosine(2.2, phase)) for phase in (1.55, 1.60))
    held = ordered(
        replayed=channel(cosine(2.2, 1.57)), replayed_lines=lines(line("1", 2.2, 1.57)), moved=moved
    )
    phase = named(order_metrics(held), "order_phase 1")
    assert phase.uncertainty == pytest.approx(np.hypot(0.02, 0.05), rel=1e-4)
