"""What a line is called: the reference records of the analysis notes, and one record per verdict."""

from __future__ import annotations

import numpy as np
import pytest

from tethertest.errors import DataError
from tethertest.records.arrays import FloatArray
from tethertest.records.channel import Channel, Flag, Window
from tethertest.records.lines import ChannelLines, Expectation, Line, LineVerdict
from tethertest.records.response import NaturalFrequency
from tethertest.spectra import find_lines, fit_drive
from tethertest.spectra.orders import length_to_resolve, resolvable_orders

from .conftest import Maker, cosine

LATERAL = NaturalFrequency("lateral 1", 0.1265)


def half_of(channel: Channel, window: Window, nominal: float, expectation: Expectation | None = None) -> Line:
    lines = analysed(channel, window, nominal, expectation).line("1/2")
    assert lines is not None
    return lines


def analysed(
    channel: Channel, window: Window, nominal: float, expectation: Expectation | None = None
) -> ChannelLines:
    drive = fit_drive([channel], window, nominal)
    return find_lines(channel, window, drive, expectation or Expectation())


class TestReferenceDemo:
    """30 Hz, 2048 samples, drive 0.24 Hz of unit amplitude, second line 0.2, noise 0.05."""

    @pytest.fixture
    def record(self, time: FloatArray) -> FloatArray:
        return cosine(time, 0.24) + 0.05 * np.random.default_rng(3).standard_normal(2048)

    def test_locked_half_is_a_subharmonic(
        self, channel: Maker, time: FloatArray, window: Window, record: FloatArray
    ) -> None:
        half = half_of(channel(time, record + cosine(time, 0.12, 0.2, 1.0)), window, 0.24)
        assert half.verdict is LineVerdict.SUBHARMONIC
        assert half.amplitude == pytest.approx(0.2, abs=0.005)
        assert half.phase == pytest.approx(1.0, abs=0.03)
        assert "D1/D2" in half.reason

    def test_free_oscillation_nearby_is_not(
        self, channel: Maker, time: FloatArray, window: Window, record: FloatArray
    ) -> None:
        half = half_of(channel(time, record + cosine(time, 0.1265, 0.2, 1.0)), window, 0.24)
        assert half.p_value < 1e-6  # the F test alone would have been taken in
        assert half.verdict is LineVerdict.UNDETERMINED
        assert "sits at 0.126" in half.reason

    def test_decaying_oscillation_is_a_natural_transient(
        self, channel: Maker, time: FloatArray, window: Window, record: FloatArray
    ) -> None:
        decaying = cosine(time, 0.1265, 0.2, 1.0) * np.exp(-time / 15.0)
        half = half_of(channel(time, record + decaying), window, 0.24)
        assert half.verdict is LineVerdict.NATURAL_TRANSIENT

    def test_nothing_is_none(
        self, channel: Maker, time: FloatArray, window: Window, record: FloatArray
    ) -> None:
        half = half_of(channel(time, record), window, 0.24)
        assert half.verdict is LineVerdict.NONE
        assert half.interval[0] == 0.0


def test_the_articles_own_situation_needs_1333_seconds(
    channel: Maker, time: FloatArray, window: Window
) -> None:
    # a drive of 0.25 Hz known to 1e-9, so that the length is that of the statement: 2 / 0.0015
    noise = 0.05 * np.random.default_rng(5).standard_normal(2048)
    record = channel(time, cosine(time, 0.25) + cosine(time, 0.1265, 0.2, 1.0) + noise)
    drive = fit_drive([channel(time, cosine(time, 0.25, 1.0))], window, 0.25)
    lines = find_lines(record, window, drive, Expectation((LATERAL,)))
    half = lines.line("1/2")
    assert half is not None
    assert half.verdict is LineVerdict.NOT_RESOLVABLE
    assert "1333 s would" in half.reason
    assert half.length_needed == pytest.approx(1333.3, abs=0.1)


def test_a_drive_near_twice_a_natural_frequency_is_named_parametric(channel: Maker) -> None:
    # 0.0085 Hz off in 300 s is 2.5 / T: told apart, and 7 % of the order
    time = np.arange(9000) / 30.0
    noise = 0.05 * np.random.default_rng(17).standard_normal(9000)
    record = channel(time, cosine(time, 0.25) + cosine(time, 0.125, 0.1, 0.5) + noise)
    near, far = (
        Expectation((NaturalFrequency("lateral 1", 0.1335),)),
        Expectation((NaturalFrequency("far", 0.9),)),
    )
    window = Window(0.0, 300.0)
    half = half_of(record, window, 0.25, near)
    assert half.verdict is LineVerdict.SUBHARMONIC
    assert "parametric resonance: the drive is near twice the natural frequency 'lateral 1'" in half.reason
    assert "parametric" not in half_of(record, window, 0.25, far).reason
    assert "no natural frequency was stated" in half_of(record, window, 0.25).reason


def test_a_half_order_that_only_the_second_half_has_is_no_subharmonic(
    channel: Maker, time: FloatArray, window: Window
) -> None:
    noise = 0.05 * np.random.default_rng(18).standard_normal(2048)
    late = np.where(time > 0.5 * time[-1], cosine(time, 0.125, 0.1, 0.5), 0.0)
    half = half_of(channel(time, cosine(time, 0.25) + late + noise), window, 0.25)
    assert half.p_value < 1e-4
    assert half.verdict in {LineVerdict.LEAKAGE, LineVerdict.UNDETERMINED}


def test_a_strong_free_line_between_the_orders_leaks_into_none_of_them(
    channel: Maker, time: FloatArray, window: Window
) -> None:
    noise = 0.02 * np.random.default_rng(6).standard_normal(2048)
    record = cosine(time, 0.25) + cosine(time, 0.4060, 0.5, 0.2) + noise
    lines = analysed(channel(time, record), window, 0.25)
    assert [line.order for line in lines.lines if line.verdict is not LineVerdict.NONE] == ["1"]


def test_a_free_line_is_named_after_the_natural_frequency_it_sits_at(channel: Maker, window: Window) -> None:
    # 0.0085 Hz off f/2: 2.1 cycles over 250 s, and close enough to reach the order
    time = np.arange(7500) / 30.0
    pendulum = NaturalFrequency("pendulum", 0.1333)
    noise = 0.2 * np.random.default_rng(6).standard_normal(7500)
    growing = cosine(time, 0.1333, 0.3, 0.2) * (0.4 + time / 250.0)
    lines = analysed(
        channel(time, cosine(time, 0.25) + growing + noise),
        Window(0.0, 250.0),
        0.25,
        Expectation((pendulum,)),
    )
    assert not any(line.verdict is LineVerdict.SUBHARMONIC for line in lines.lines)


@pytest.fixture
def kinked(channel: Maker, time: FloatArray) -> Channel:
    """Drive with a second order of 0.25 and a third of 0.1."""
    noise = 0.02 * np.random.default_rng(7).standard_normal(2048)
    values = cosine(time, 0.25) + cosine(time, 0.5, 0.25, 0.3) + cosine(time, 0.75, 0.1, -0.5)
    return channel(time, values + noise)


def test_whole_orders_are_harmonics_where_nothing_explains_them(kinked: Channel, window: Window) -> None:
    lines = analysed(kinked, window, 0.25)
    verdicts = {line.order: line.verdict for line in lines.lines}
    assert verdicts["1"] is verdicts["2"] is verdicts["3"] is LineVerdict.HARMONIC
    assert verdicts["4"] is verdicts["5"] is LineVerdict.NONE


def test_an_order_of_the_predicted_size_is_the_cranks_and_one_of_another_size_is_not(
    kinked: Channel, window: Window
) -> None:
    told = Expectation(crank_orders={"2": 0.254, "3": 0.0})
    lines = analysed(kinked, window, 0.25, told)
    second, third = lines.line("2"), lines.line("3")
    assert second is not None
    assert second.verdict is LineVerdict.CRANK_HARMONIC
    assert third is not None
    assert third.verdict is LineVerdict.HARMONIC
    doubled = analysed(kinked, window, 0.25, Expectation(crank_orders={"2": 0.5})).line("2")
    assert doubled is not None
    assert doubled.verdict is LineVerdict.HARMONIC
    assert "predict 0.5 of order 1, found 0.25" in doubled.reason


@pytest.mark.parametrize(
    ("carried", "verdict"), [(0.03, LineVerdict.INPUT_BORNE), (0.0005, LineVerdict.SUBHARMONIC)]
)
def test_a_half_order_belongs_to_the_motion_only_in_the_amount_it_carries(
    carried: float, verdict: LineVerdict, channel: Maker, time: FloatArray, window: Window
) -> None:
    random = np.random.default_rng(8)
    motion = 0.1 * (cosine(time, 0.25) + cosine(time, 0.125, carried, 0.4))
    heave = channel(
        time,
        motion + 1e-6 * random.standard_normal(2048),
        name="heave",
        kind="displacement",
        unit="m",
        at=0.0,
    )
    tension = channel(
        time, cosine(time, 0.25) + cosine(time, 0.125, 0.03) + 0.01 * random.standard_normal(2048)
    )
    drive = fit_drive([heave], window, 0.25)
    motion_lines = find_lines(heave, window, drive, Expectation())
    own = motion_lines.line("1/2")
    assert own is not None
    assert own.verdict is LineVerdict.INPUT_BORNE
    half = find_lines(tension, window, drive, Expectation(input_lines=motion_lines)).line("1/2")
    assert half is not None
    assert half.verdict is verdict


def test_hum_folded_onto_an_order_is_the_mains(channel: Maker) -> None:
    # 50 Hz sampled at 49.5 Hz shows at 0.5 Hz, the second order of 0.25 Hz
    time = np.arange(3000) / 49.5
    noise = 0.02 * np.random.default_rng(9).standard_normal(3000)
    record = channel(time, cosine(time, 0.25) + cosine(time, 50.0, 0.2) + noise)
    second = analysed(record, Window(0.0, time[-1]), 0.25).line("2")
    assert second is not None
    assert second.verdict is LineVerdict.MAINS
    assert "50 Hz" in second.reason


def test_the_second_order_folded_onto_a_half_is_an_alias(channel: Maker) -> None:
    # 10 Hz sampling of a 4 Hz drive: order 2 at 8 Hz shows at 2 Hz, order 1/2
    time = np.arange(1200) / 10.0
    noise = 0.1 * np.random.default_rng(4).standard_normal(1200)
    record = channel(time, 10.0 * cosine(time, 4.0) + cosine(time, 8.0) + noise)
    half = analysed(record, Window(0.0, time[-1]), 4.0).line("1/2")
    assert half is not None
    assert half.verdict is LineVerdict.ALIAS
    assert "order 2 folds here" in half.reason


def test_a_high_order_folded_onto_a_third_is_an_alias(channel: Maker) -> None:
    # 100 Hz sampling of a 7.5 Hz drive with sharp peaks: order 13 at 97.5 Hz shows at 2.5 Hz, order 1/3
    time = np.arange(3000) / 100.0
    sharp = sum(cosine(time, 7.5 * order, 0.6**order) for order in range(1, 16))
    record = channel(time, 10.0 * sharp + 0.002 * np.random.default_rng(10).standard_normal(3000))
    third = analysed(record, Window(0.0, time[-1]), 7.5).line("1/3")
    assert third is not None
    assert third.verdict is LineVerdict.ALIAS
    assert "order 13" in third.reason


def test_an_event_at_the_ends_of_the_window_makes_no_subharmonic(
    channel: Maker, time: FloatArray, window: Window
) -> None:
    ends = np.exp(-time / 2.0) + np.exp(-(time[-1] - time) / 2.0)
    noise = 0.002 * np.random.default_rng(11).standard_normal(2048)
    record = channel(time, cosine(time, 0.25) * (1.0 - 0.2 * ends) + noise)
    lines = analysed(record, window, 0.25)
    assert not any(line.verdict is LineVerdict.SUBHARMONIC for line in lines.lines)


def test_a_short_record_says_how_long_a_longer_one_must_be(channel: Maker) -> None:
    time = np.arange(400) / 30.0  # 3.3 periods
    noise = 0.02 * np.random.default_rng(12).standard_normal(400)
    half = half_of(channel(time, cosine(time, 0.25) + noise), Window(0.0, time[-1]), 0.25)
    assert half.verdict is LineVerdict.NOT_RESOLVABLE
    assert "24.0 s would" in half.reason  # six periods tell 1/2 from 1/3 and 2/3


def test_orders_are_told_apart_from_one_cycle_between_them_on() -> None:
    from tethertest.spectra import ORDERS

    some = [str(order) for order in resolvable_orders(ORDERS, 0.25, 20.0, 10.0)]
    assert some == ["1/2", "1", "3/2", "2", "5/2", "3", "4", "5"]
    assert len(resolvable_orders(ORDERS, 0.25, 24.0, 10.0)) == len(ORDERS)
    assert length_to_resolve(ORDERS[1], ORDERS, 0.25) == pytest.approx(24.0)


def test_flagged_samples_are_left_out_and_counted(channel: Maker, time: FloatArray, window: Window) -> None:
    noise = 0.01 * np.random.default_rng(13).standard_normal(2048)
    broken = np.zeros(2048, dtype=bool)
    broken[300:400] = True
    values = np.where(broken, 40.0, cosine(time, 0.25, 1.0, 0.7) + noise)
    record = channel(time, values).with_flags(broken, Flag.SPIKE)
    lines = analysed(record, window, 0.25)
    first = lines.line("1")
    assert first is not None
    assert first.amplitude == pytest.approx(1.0, abs=0.002)
    assert (lines.samples, lines.left_out) == (1948, 100)


def test_phase_refers_to_the_start_of_the_window(channel: Maker, time: FloatArray) -> None:
    noise = 1e-4 * np.random.default_rng(14).standard_normal(2048)
    record = channel(time, cosine(time, 0.25, 1.0, 0.7) + noise)
    first = analysed(record, Window(5.0, 65.0), 0.25).line("1")
    assert first is not None
    # 5 s are 1.25 periods
    assert first.phase == pytest.approx(0.7 + np.pi / 2, abs=0.01)


def test_orders_above_half_the_rate_are_not_looked_for(channel: Maker) -> None:
    time = np.arange(400) / 7.0
    record = channel(time, cosine(time, 1.0) + 0.1 * np.random.default_rng(15).standard_normal(400))
    orders = [line.order for line in analysed(record, Window(0.0, time[-1]), 1.0).lines]
    assert orders[-1] == "3"


def test_two_periods_are_too_few(channel: Maker, time: FloatArray) -> None:
    with pytest.raises(DataError, match=r"2 periods of 0.25 Hz, expected at least 2.5"):
        fit_drive([channel(time, cosine(time, 0.25))], Window(0.0, 8.0), 0.25)
