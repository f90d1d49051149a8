"""What a log shows of its own faults reaches its analysis, and what nobody measured is said."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from tethertest.errors import DataError
from tethertest.jobs.analysis_options import Options
from tethertest.jobs.analyze import analyze
from tethertest.records.analysis import Analysis
from tethertest.records.lines import LineVerdict

RATE = 100.0
TIME = np.arange(6000) / RATE


def tension(amplitude: float = 10.0, noise: float = 0.1, seed: int = 3) -> np.ndarray:
    return (
        50.0
        + amplitude * np.sin(2.0 * np.pi * TIME)
        + np.random.default_rng(seed).normal(0.0, noise, TIME.size)
    )


def log(path: Path, time: list[str], **columns: list[str]) -> Path:
    names = ",".join(["time [s]", *(f"{name} [N]" for name in columns)])
    rows = [",".join(row) for row in zip(time, *columns.values(), strict=True)]
    path.write_text("\n".join([names, *rows]) + "\n", encoding="utf-8")
    return path


def cells(values: np.ndarray, digits: int = 4) -> list[str]:
    return [f"{value:.{digits}f}" for value in values]


def analysed(path: Path, drive: float | None = 1.0, window: tuple[float, float] | None = None) -> Analysis:
    return analyze(path, Options(drive_frequency=drive, window=window))


def amplitude_and_interval(analysis: Analysis, name: str) -> tuple[float, float, float]:
    lines = analysis.find(name).lines
    line = lines.line("1")
    return line.amplitude, *line.interval


def test_an_amplifier_at_its_limit_leaves_the_lines_undetermined(tmp_path: Path) -> None:
    clipped = np.minimum(tension(), 56.0)
    found = analysed(log(tmp_path / "a.csv", cells(TIME, 2), F=cells(clipped)))
    line = found.find("F").lines.line("1")
    assert line.verdict is LineVerdict.UNDETERMINED
    assert "at the amplifier's limit" in line.reason
    assert any("saturated of 6000 samples are left out" in note for note in found.notes)


def test_a_frozen_channel_is_left_out_where_it_stands(tmp_path: Path) -> None:
    frozen = tension()
    frozen[2500:] = frozen[2500]
    found = analysed(log(tmp_path / "a.csv", cells(TIME, 2), F=cells(frozen), G=cells(tension(seed=4))))
    item = found.find("F")
    assert any("3500 stuck of 6000 samples" in note for note in found.notes)
    assert item.cycles.equivalent_range == pytest.approx(20.4, abs=0.5)


@pytest.mark.parametrize("held", [False, True])
def test_a_slower_channel_in_the_same_table_keeps_its_amplitude(tmp_path: Path, held: bool) -> None:
    slow = cells(tension(9.0, seed=5))
    column = [slow[row // 10 * 10] if held or row % 10 == 0 else "" for row in range(TIME.size)]
    found = analysed(log(tmp_path / "a.csv", cells(TIME, 2), F=cells(tension()), slow=column))
    value, low, high = amplitude_and_interval(found, "slow")
    assert low <= 9.0 <= high
    assert value == pytest.approx(9.0, abs=0.05)
    assert found.find("slow").lines.line("1").phase == pytest.approx(
        found.find("F").lines.line("1").phase, abs=0.01
    )
    assert sum("'slow'" in note for note in found.notes) == 1


def test_every_second_value_missing_changes_nothing_but_the_interval(tmp_path: Path) -> None:
    column = cells(tension())
    for row in (*range(1, 6000, 2), 100, 302, 1002, *range(2000, 2400, 2)):
        column[row] = ""
    found = analysed(log(tmp_path / "a.csv", cells(TIME, 2), F=column), window=(1.0, 59.0))
    _, low, high = amplitude_and_interval(found, "F")
    assert low <= 10.0 <= high
    assert high - low < 0.05
    assert abs(found.drive.frequency - 1.0) < 4.0 * found.drive.standard_error < 1e-4


@pytest.mark.parametrize("code", ["-9999", "9.99e37", "-9.91E+37"])
def test_a_number_for_no_value_is_left_out(tmp_path: Path, code: str) -> None:
    column = cells(tension())
    column[700] = column[3000] = code
    found = analysed(log(tmp_path / "a.csv", cells(TIME, 2), F=column))
    assert 39.0 < found.find("F").extremes.minimum < found.find("F").extremes.maximum < 61.0
    assert any("they are left out" in note for note in found.notes)


@pytest.mark.parametrize("count", [5, 60, 120])
def test_lost_samples_written_as_zero_are_left_out_however_many(tmp_path: Path, count: int) -> None:
    values = tension()
    values[np.random.default_rng(6).choice(np.arange(10, 5990), count, replace=False)] = 0.0
    found = analysed(log(tmp_path / "a.csv", cells(TIME, 2), F=cells(values)))
    assert found.find("F").extremes.minimum > 39.0
    assert found.find("F").channel.flag_counts() == {"spike": count}


@pytest.mark.parametrize("rate", [30.0, 60.0, 144.0, 400.0, 700.0])
def test_stamps_in_milliseconds_do_not_shift_frequencies(tmp_path: Path, rate: float) -> None:
    time = np.arange(int(120.0 * rate)) / rate
    values = 50.0 + 10.0 * np.sin(2.0 * np.pi * time) + 2.0 * np.sin(2.0 * np.pi * 7.0 * time)
    values += np.random.default_rng(7).normal(0.0, 0.1, time.size)
    found = analysed(log(tmp_path / "a.csv", cells(time, 3), F=cells(values)), drive=None)
    assert found.find("F").channel.rate == pytest.approx(rate, rel=1e-5)
    peaks = sorted(peak.frequency for peak in found.find("F").peaks)
    assert peaks == pytest.approx([1.0, 7.0], rel=1e-3)


def test_a_half_order_without_a_measured_motion_is_said_to_lack_it(tmp_path: Path) -> None:
    values = tension() + 0.5 * np.sin(np.pi * TIME)
    found = analysed(log(tmp_path / "a.csv", cells(TIME, 2), F=cells(values)))
    line = found.find("F").lines.line("1/2")
    assert line.verdict is LineVerdict.SUBHARMONIC
    assert "no bottom motion was measured" in line.reason
    assert "not in the input" not in line.reason
    assert any(note.startswith("F 1/2: no bottom motion was measured") for note in found.notes)


def test_hum_that_hides_load_cycles_is_said(tmp_path: Path) -> None:
    values = tension() + 2.0 * np.sin(2.0 * np.pi * 49.7 * TIME)
    found = analysed(log(tmp_path / "a.csv", cells(TIME, 2), F=cells(values)))
    assert any("load cycles below" in note for note in found.notes)


def test_lines_that_rounding_may_have_made_are_named(tmp_path: Path) -> None:
    values = tension(0.6, noise=0.0)
    found = analysed(log(tmp_path / "a.csv", cells(TIME, 2), F=cells(values, 0)))
    assert any("steps of 1 N" in note and "as at 3" in note for note in found.notes)


def test_a_short_window_says_what_it_takes_for_granted(tmp_path: Path) -> None:
    found = analysed(log(tmp_path / "a.csv", cells(TIME, 2), F=cells(tension())), window=(10.0, 13.5))
    assert any("cannot tell order 1/3, 1/2 from the others" in note for note in found.notes)


def test_a_clean_log_has_no_notes(tmp_path: Path) -> None:
    assert not analysed(log(tmp_path / "a.csv", cells(TIME, 2), F=cells(tension()))).notes


@pytest.mark.parametrize("back", [0.3, 3.0])
def test_a_time_that_goes_back_for_long_is_refused(tmp_path: Path, back: float) -> None:
    time = TIME - back * TIME[-1] * (np.arange(TIME.size) >= TIME.size // 2)
    with pytest.raises(DataError, match="samples does not go forward, first after") as caught:
        analysed(log(tmp_path / "a.csv", cells(time, 3), F=cells(tension())))
    assert "--set rate" in caught.value.remedy


def test_rows_newest_first_are_refused_with_what_to_do(tmp_path: Path) -> None:
    with pytest.raises(DataError, match="the time goes forward in 1 of 6000 rows only"):
        analysed(log(tmp_path / "a.csv", cells(TIME[::-1], 2), F=cells(tension())))
