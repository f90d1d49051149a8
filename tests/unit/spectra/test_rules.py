"""The rules of a line's verdict one by one, each threshold from both sides, on evidence made by hand."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest

from tethertest.records.channel import Window
from tethertest.records.lines import ChannelLines, Expectation, Line, LineVerdict, OrderTrack
from tethertest.records.response import NaturalFrequency
from tethertest.spectra.inputs import explain_by_input
from tethertest.spectra.multitaper import MultitaperTest
from tethertest.spectra.regression import Amplitude, stands_out
from tethertest.spectra.stroboscopic_section import Section
from tethertest.spectra.tracking import Tracking
from tethertest.spectra.verdicts import Evidence, judge, length_needed

HALF = Fraction(1, 2)
NOTHING = np.empty(0)
STEADY = Tracking(
    frequency=0.125,
    frequency_error=1e-4,
    gain=1.0,
    penalty=7.0,
    cycles=0.01,
    growth=0.0,
    growth_error=0.01,
    drift=0.0,
    drift_error=0.01,
    thirds=1.0,
    departure=0.1,
    track=OrderTrack(NOTHING, NOTHING, NOTHING, NOTHING, NOTHING),
    second_opinion=MultitaperTest(30.0, 1e-4),
)
LOCKED = Evidence(
    order=HALF,
    frequency=0.125,
    amplitude=Amplitude(0.2, 0.0, 0.01, (0.18, 0.22), 200.0, 1e-9),
    fundamental=1.0,
    unit="N",
    adjusted=1e-8,
    significant=True,
    alias=None,
    is_input=False,
    leakage_floor=0.0,
    nearby_peak=0.0,
    local_p_value=1e-6,
    length=100.0,
    rate=1000.0,
    tracking=STEADY,
    source=None,
    section=None,
    saturated=0,
    wander=0.0,
    side_line=False,
    expectation=Expectation(),
)
SECOND = replace(LOCKED, order=Fraction(2), frequency=0.5, tracking=None)


def verdict(evidence: Evidence, **fields: object) -> LineVerdict:
    return judge(replace(evidence, **fields))[0]  # type: ignore[arg-type]


def near(frequency: float) -> Expectation:
    return Expectation((NaturalFrequency("lateral 1", frequency),))


def motion(*found: Line) -> ChannelLines:
    return ChannelLines("heave", "m", Window(0.0, 100.0), found, 1000, 0)


def line(order: str, amplitude: float, is_there: bool = True) -> Line:
    kind = LineVerdict.HARMONIC if is_there else LineVerdict.NONE
    return Line(order, 0.25, amplitude, 0.0, (0.0, 1.0), 0.001, 0.0, kind, "")


def test_a_locked_steady_line_that_nothing_explains_is_a_subharmonic() -> None:
    found, reason = judge(LOCKED)
    assert found is LineVerdict.SUBHARMONIC
    assert reason.startswith("0.2 N (0.18 to 0.22), 0.2 of order 1: locked to the drive")
    assert "0.01 cycles off over the record, chi-squared gain 1 of 7" in reason
    assert "multitaper F = 30" in reason
    assert "no bottom motion was measured" in reason
    assert "no natural frequency was stated: one within 0.0003 Hz" in reason
    section = judge(replace(LOCKED, section=Section(8.0, 2.0)))[1]
    assert "stroboscopic section D1/D2 = 4" in section


def test_a_line_within_chance_is_none_and_says_what_would_show() -> None:
    found, reason = judge(replace(LOCKED, significant=False, adjusted=0.4))
    assert found is LineVerdict.NONE
    assert "amplitudes from 0.055 N would show" in reason  # 5.5 standard errors of 0.01
    assert verdict(LOCKED, significant=False, saturated=3) is LineVerdict.NONE


def test_lost_peaks_leave_amplitudes_undetermined_and_order_1_even_where_it_is_not_significant() -> None:
    found, reason = judge(replace(LOCKED, saturated=7))
    assert found is LineVerdict.UNDETERMINED
    assert "7 samples at the amplifier's limit" in reason
    first = replace(LOCKED, order=Fraction(1), frequency=0.25)
    assert verdict(first, saturated=7, significant=False) is LineVerdict.UNDETERMINED
    assert verdict(first, significant=False) is LineVerdict.NONE
    assert judge(first) == (LineVerdict.HARMONIC, "the drive itself, 0.2 N (0.18 to 0.22)")


@pytest.mark.parametrize(
    ("frequency", "rate", "found"),
    [
        (49.991, 1000.0, True),
        (49.989, 1000.0, False),
        (50.009, 1000.0, True),
        (100.0, 1000.0, True),
        (150.0, 1000.0, True),
        (200.0, 1000.0, False),
        (1.0, 49.0, True),  # 50 Hz folded
        (3.0, 49.0, True),  # 150 Hz folded
        (0.005, 50.0, False),  # folded onto zero: nothing is seen
    ],
)
def test_mains_are_those_within_one_resolution_of_its_first_three_multiples(
    frequency: float, rate: float, found: bool
) -> None:
    hum = replace(LOCKED, order=Fraction(200), frequency=frequency, rate=rate, tracking=None)
    assert (verdict(hum) is LineVerdict.MAINS) is found
    if found and rate == 49.0:
        assert "folded to" in judge(hum)[1]


def test_whole_orders_stand_out_of_their_surroundings_or_are_leakage() -> None:
    assert verdict(SECOND, local_p_value=0.002) is LineVerdict.HARMONIC
    assert verdict(SECOND, local_p_value=0.0021) is LineVerdict.LEAKAGE


def test_whole_orders_say_what_makes_them() -> None:
    def reason(**fields: object) -> str:
        return judge(replace(SECOND, **fields))[1]  # type: ignore[arg-type]

    assert "no bottom motion was measured, and no crank is known" in reason()
    assert "not made by the crank" in reason(expectation=Expectation(crank_orders={"2": 0.9}))
    assert "not made by the crank" in reason(expectation=Expectation(input_lines=motion()))
    assert "in the bottom motion itself" in reason(is_input=True)


def test_a_whole_order_next_to_a_natural_frequency_decays_or_is_steady() -> None:
    decaying = replace(STEADY, growth=-0.5, growth_error=0.01)
    close = replace(SECOND, expectation=near(0.51), tracking=decaying)
    assert verdict(close) is LineVerdict.NATURAL_TRANSIENT
    assert "50% +/- 1% of its amplitude is lost" in judge(close)[1]
    assert verdict(close, tracking=STEADY) is LineVerdict.HARMONIC
    assert "'lateral 1' (0.51 Hz) is next to it" in judge(replace(close, tracking=STEADY))[1]
    assert verdict(close, expectation=near(0.6)) is LineVerdict.HARMONIC
    all_lost = replace(close, tracking=replace(decaying, growth=-1.0))
    assert "all of its amplitude is lost" in judge(all_lost)[1]


def test_conditions_of_a_subharmonic_the_first_that_fails_decides() -> None:
    assert verdict(LOCKED, alias=Fraction(2)) is LineVerdict.ALIAS
    assert "any tension may have it" in judge(replace(LOCKED, alias=Fraction(4)))[1]
    assert "the orders below it are strong" in judge(replace(LOCKED, alias=Fraction(5)))[1]
    assert verdict(LOCKED, source=0.13) is LineVerdict.LEAKAGE
    assert verdict(LOCKED, tracking=None) is LineVerdict.UNDETERMINED
    assert verdict(LOCKED, local_p_value=0.002) is LineVerdict.SUBHARMONIC
    assert verdict(LOCKED, local_p_value=0.0021) is LineVerdict.LEAKAGE
    assert verdict(LOCKED, leakage_floor=0.2) is LineVerdict.SUBHARMONIC
    assert verdict(LOCKED, leakage_floor=0.2001) is LineVerdict.LEAKAGE
    assert verdict(LOCKED, wander=0.2) is LineVerdict.SUBHARMONIC
    assert verdict(LOCKED, wander=0.2001) is LineVerdict.UNDETERMINED
    assert verdict(LOCKED, wander=0.11, fundamental=2.0) is LineVerdict.UNDETERMINED
    assert verdict(LOCKED, side_line=True) is LineVerdict.UNDETERMINED
    found, reason = judge(replace(LOCKED, is_input=True))
    assert found is LineVerdict.INPUT_BORNE
    assert "the bottom motion itself has it" in reason


def test_a_line_has_three_times_the_power_of_what_is_left_beside_it() -> None:
    assert stands_out(np.sqrt(3.0) * (1 + 1e-12), 1.0)
    assert not stands_out(1.73, 1.0)
    assert stands_out(0.0, 0.0)
    assert verdict(LOCKED, nearby_peak=0.115) is LineVerdict.SUBHARMONIC
    assert verdict(LOCKED, nearby_peak=0.116) is LineVerdict.LEAKAGE


@pytest.mark.parametrize(
    ("change", "expected"),
    [
        ({"growth": -0.2, "growth_error": 0.01}, LineVerdict.SUBHARMONIC),
        ({"growth": -0.21, "growth_error": 0.01}, LineVerdict.NATURAL_TRANSIENT),
        ({"growth": -0.27, "growth_error": 0.1}, LineVerdict.SUBHARMONIC),
        ({"growth": -0.29, "growth_error": 0.1}, LineVerdict.NATURAL_TRANSIENT),
        ({"growth": 0.9}, LineVerdict.SUBHARMONIC),
        ({"gain": 7.0, "cycles": 1.0}, LineVerdict.SUBHARMONIC),
        ({"gain": 7.1, "cycles": 0.03}, LineVerdict.SUBHARMONIC),
        ({"gain": 7.1, "cycles": -0.03}, LineVerdict.SUBHARMONIC),
        ({"gain": 7.1, "cycles": 0.031}, LineVerdict.UNDETERMINED),
        ({"gain": 7.1, "cycles": -0.031}, LineVerdict.UNDETERMINED),
        ({"thirds": 14.87, "departure": 0.61}, LineVerdict.UNDETERMINED),
        ({"thirds": 14.86, "departure": 0.61}, LineVerdict.SUBHARMONIC),
        ({"thirds": 14.87, "departure": 0.6}, LineVerdict.SUBHARMONIC),
        ({"drift": 0.19}, LineVerdict.UNDETERMINED),  # two pi times 0.03 is 0.1885
        ({"drift": -0.19}, LineVerdict.UNDETERMINED),
        ({"drift": 0.188}, LineVerdict.SUBHARMONIC),
        ({"drift": 0.27, "drift_error": 0.1}, LineVerdict.SUBHARMONIC),
        ({"drift": 0.29, "drift_error": 0.1}, LineVerdict.UNDETERMINED),
    ],
)
def test_what_a_line_may_do_over_the_record(change: dict[str, float], expected: LineVerdict) -> None:
    assert verdict(LOCKED, tracking=replace(STEADY, **change)) is expected


def test_a_free_line_is_a_natural_transient_only_at_a_natural_frequency() -> None:
    # within 2.8 standard errors or half a resolution of it, whichever is more
    loose = replace(STEADY, gain=100.0, cycles=2.5, frequency=0.15, frequency_error=1e-4)
    for natural, expected in (
        (0.1549, LineVerdict.NATURAL_TRANSIENT),
        (0.1551, LineVerdict.UNDETERMINED),
        (0.1451, LineVerdict.NATURAL_TRANSIENT),
    ):
        assert verdict(LOCKED, tracking=loose, expectation=near(natural)) is expected
    unsure = replace(loose, frequency_error=0.01)
    assert verdict(LOCKED, tracking=unsure, expectation=near(0.177)) is LineVerdict.NATURAL_TRANSIENT
    assert verdict(LOCKED, tracking=unsure, expectation=near(0.179)) is LineVerdict.UNDETERMINED
    assert (
        "sits at 0.15 Hz, not at 0.125 Hz (chi-squared gain 1e+02)"
        in judge(replace(LOCKED, tracking=loose))[1]
    )


def test_a_natural_frequency_closer_than_two_resolutions_cannot_be_told_apart() -> None:
    close = replace(LOCKED, expectation=near(0.1449))
    assert verdict(close) is LineVerdict.NOT_RESOLVABLE
    assert length_needed(close) == pytest.approx(2.0 / 0.0199)
    assert "101 s would" in judge(close)[1]
    far = replace(LOCKED, expectation=near(0.1451))
    assert verdict(far) is LineVerdict.SUBHARMONIC
    assert length_needed(far) is None
    equal = replace(LOCKED, expectation=near(0.125 * (1 + 5e-7)))
    assert length_needed(equal) is None
    assert "no record length tells them apart" in judge(equal)[1]
    assert length_needed(replace(LOCKED, expectation=near(0.125 * (1 + 2e-6)))) == pytest.approx(8e6)
    assert length_needed(LOCKED) is None


def test_of_several_natural_frequencies_the_nearest_counts() -> None:
    several = Expectation(tuple(NaturalFrequency(str(at), at) for at in (0.5, 0.13, 0.02)))
    assert "'0.13' (0.13 Hz)" in judge(replace(LOCKED, expectation=several))[1]


def test_parametric_resonance_is_named_within_a_tenth_and_at_order_one_half_only() -> None:
    long = replace(LOCKED, length=1000.0)
    for natural, named in ((0.1374, True), (0.1376, False), (0.1126, True), (0.1124, False)):
        assert ("parametric resonance" in judge(replace(long, expectation=near(natural)))[1]) is named
    third = replace(long, order=Fraction(1, 3), expectation=near(0.13))
    assert "parametric" not in judge(third)[1]
    short = judge(replace(LOCKED, expectation=near(0.13)))[1]
    assert "a parametric resonance would look the same" in short


# what the bottom motion brings in


@pytest.mark.parametrize(
    ("amplitude", "explained"), [(0.5, True), (0.626, False), (0.624, True), (0.376, True), (0.374, False)]
)
def test_a_predicted_ratio_holds_within_a_quarter(amplitude: float, explained: bool) -> None:
    told = Expectation(crank_orders={"2": 0.25})
    found = explain_by_input(Fraction(2), amplitude, 0.0, 2.0, told)
    assert found.explained is explained
    assert f"predict 0.25 of order 1, found {amplitude / 2.0:.3g}" in found.text


def test_two_standard_errors_of_the_line_widen_what_is_explained() -> None:
    told = Expectation(crank_orders={"2": 0.25, "3": 0.0})
    # 0.25 x 1.25 = 0.3125 of order 1; two standard errors of 0.04 over 2.0 are 0.04
    assert explain_by_input(Fraction(2), 0.704, 0.04, 2.0, told).explained
    assert not explain_by_input(Fraction(2), 0.706, 0.04, 2.0, told).explained
    nothing = explain_by_input(Fraction(3), 0.01, 0.0, 2.0, told)
    assert not nothing.explained
    assert "predict nothing at this order" in nothing.text


@pytest.mark.parametrize(
    ("order", "ratio", "explained"),
    [
        # the motion carries 0.1 of its order 1: at order 2 from half of that to eight times it
        ("2", 0.051, True),
        ("2", 0.049, False),
        ("2", 0.799, True),
        ("2", 0.801, False),
        # at order 1/2 from an eighth to twice
        ("1/2", 0.0126, True),
        ("1/2", 0.0124, False),
        ("1/2", 0.199, True),
        ("1/2", 0.201, False),
    ],
)
def test_a_measured_motion_explains_from_stiffness_to_inertia(
    order: str, ratio: float, explained: bool
) -> None:
    told = Expectation(input_lines=motion(line("1", 0.5), line(order, 0.05)))
    found = explain_by_input(Fraction(order), 2.0 * ratio, 0.0, 2.0, told)
    assert found.explained is explained
    assert "carries 0.1 of its order 1" in found.text


def test_a_motion_without_the_order_or_without_order_1_says_nothing() -> None:
    for lines in (
        motion(line("1", 0.5)),
        motion(line("2", 0.05)),
        motion(line("1", 0.5, is_there=False), line("2", 0.05)),
        motion(line("1", 0.5), line("2", 0.05, is_there=False)),
        motion(line("1", 0.0), line("2", 0.05)),
        None,
    ):
        found = explain_by_input(Fraction(2), 0.4, 0.0, 2.0, Expectation(input_lines=lines))
        assert (found.explained, found.text) == (False, "")


def test_what_the_motion_explains_is_the_cranks_or_borne_in() -> None:
    told = Expectation(crank_orders={"2": 0.2, "1/2": 0.2})
    assert verdict(SECOND, expectation=told) is LineVerdict.CRANK_HARMONIC
    assert verdict(LOCKED, expectation=told) is LineVerdict.INPUT_BORNE
    wrong = Expectation(crank_orders={"1/2": 0.6})
    found, reason = judge(replace(LOCKED, expectation=wrong))
    assert found is LineVerdict.SUBHARMONIC
    assert reason.endswith("; bottom motion and linear response predict 0.6 of order 1, found 0.2")
    known = judge(replace(LOCKED, expectation=Expectation(input_lines=motion())))[1]
    assert ": not in the input, locked" in known
