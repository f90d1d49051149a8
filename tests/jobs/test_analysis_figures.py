"""``tethertest analyze -o``: the files, and what the figures are given to show."""

from __future__ import annotations

import csv
import json
import struct
from pathlib import Path

import numpy as np
import pytest

from tethertest.cli import app
from tethertest.errors import TethertestError
from tethertest.jobs.analysis_options import asked_options
from tethertest.jobs.analyze import analyze
from tethertest.records.analysis import Analysis
from tethertest.records.channel import Window
from tethertest.render.analysis_files import write_analysis
from tethertest.render.figures.analysis import spectrum_figure
from tethertest.render.figures.marks import SpectrumMarks, spectrum_marks
from tethertest.spectra.spectrum import spectrum
from tethertest.spectra.thomson import blind_search

DRIVE = 0.5
TIME = np.arange(4000) / 100.0
SPAN = (0.1, 50.0)
KINDS = ("portrait", "spectrogram", "spectrum")


def cosine(frequency: float, amplitude: float) -> np.ndarray:
    return amplitude * np.cos(2.0 * np.pi * frequency * TIME + 0.3)


def written(path: Path, columns: dict[str, np.ndarray], samples: int = TIME.size) -> Path:
    table = np.column_stack([TIME, *columns.values()])[:samples]
    rows = [",".join(f"{value:.9g}" for value in row) for row in table]
    path.write_text("\n".join([",".join(["time [s]", *columns]), *rows]) + "\n", encoding="utf-8")
    return path


@pytest.fixture
def log(tmp_path: Path) -> Path:
    noise = 0.01 * np.random.default_rng(1).standard_normal((2, TIME.size))
    force = 5.0 + cosine(DRIVE, 1.0) + cosine(1.5, 0.24) + cosine(0.25, 0.1) + noise[0]
    return written(
        tmp_path / "log.csv", {"Force [N]": force, "FORCE [N]": 2.0 * cosine(DRIVE, 1.0) + noise[1]}
    )


def analysed(log: Path, **options: object) -> Analysis:
    return analyze(log, asked_options(drive_frequency="0.5", **options))  # type: ignore[arg-type]


def marks_of(analysis: Analysis, factor: float = 1.0, span: tuple[float, float] = SPAN) -> SpectrumMarks:
    item = analysis.channels[0]
    window = analysis.window or Window(0.0, float(TIME[-1]))
    search = blind_search(item.channel, window) if item.lines is None else None
    return spectrum_marks(item, analysis.natural_frequencies, search, factor, span)


def test_every_channel_has_its_figures_under_a_name_of_its_own(log: Path, tmp_path: Path) -> None:
    """Two names that differ in case alone are one file to some file systems."""
    paths, left_out = write_analysis(analysed(log), tmp_path / "out")
    assert left_out == ()
    names = sorted(path.name for path in (tmp_path / "out").iterdir())
    assert names == sorted(path.name for path in paths)
    drawn = [name for name in names if name.endswith(".png")]
    assert drawn == sorted(f"{name}-{kind}.png" for name in ("FORCE-2", "Force") for kind in KINDS)
    assert sorted(set(names) - set(drawn)) == ["analysis.json", "analysis.md", "orders.csv"]
    for name in drawn:
        start = (tmp_path / "out" / name).read_bytes()[:24]
        assert start[:8] == b"\x89PNG\r\n\x1a\n"
        width, height = struct.unpack(">II", start[16:])
        assert width > height > 300


def test_page_table_and_numbers_agree_and_come_out_the_same_again(log: Path, tmp_path: Path) -> None:
    found = analysed(log, channels=("Force",))
    one, _ = write_analysis(found, tmp_path)
    two, _ = write_analysis(found, tmp_path / "again")
    assert [path.read_bytes() for path in one] == [path.read_bytes() for path in two]
    (channel,) = json.loads((tmp_path / "analysis.json").read_text(encoding="utf-8"))["channels"]
    lines = {line["order"]: line for line in channel["lines"]}
    with (tmp_path / "orders.csv").open(encoding="utf-8", newline="") as stream:
        rows = {row["order"]: row for row in csv.DictReader(stream)}
    assert rows.keys() == lines.keys()
    for order, row in rows.items():
        assert row["verdict"] == lines[order]["verdict"]
        for column in ("amplitude", "significant_above", "phase", "p_value", "standard_error"):
            name = "phase_rad" if column == "phase" else column
            if lines[order][column] is not None:
                assert float(row[name]) == pytest.approx(lines[order][column], rel=1e-6, abs=1e-300)
    page = (tmp_path / "analysis.md").read_text(encoding="utf-8")
    table = [row.strip("| ").split(" | ") for row in page.splitlines() if row.startswith("| ")]
    assert [row[0] for row in table] == ["order", "---", *lines]
    for row in table[2:]:
        assert row[6] == lines[row[0]]["verdict"]
        assert float(row[1]) == pytest.approx(lines[row[0]]["frequency"], rel=1e-4)
    for kind in KINDS:
        assert f"![Force-{kind}.png](Force-{kind}.png)" in page


def test_the_spectrum_marks_orders_with_verdicts_naturals_and_levels(log: Path) -> None:
    marks = marks_of(analysed(log, naturals=("3.3", "70", "0.02")), factor=1000.0)
    labels = [mark.label for mark in marks.orders]
    orders = ("1/3", "1/2", "2/3", "1", "3/2", "2", "5/2", "3", "4", "5")
    assert [label.split("  ")[0] for label in labels] == list(orders)
    assert "1/2  subharmonic" in labels
    assert "1  harmonic" in labels
    assert "3  harmonic" in labels
    found = {mark.label: mark for mark in marks.orders if mark.found}
    assert found.keys() == {"1/2  subharmonic", "1  harmonic", "3  harmonic"}
    for label, order, amplitude in (("1/2  subharmonic", 0.5, 100.0), ("3  harmonic", 3.0, 240.0)):
        mark = found[label]
        assert mark.frequency == pytest.approx(order * DRIVE, rel=1e-4)
        assert mark.amplitude == pytest.approx(amplitude, rel=0.02)
        assert mark.interval[0] < mark.amplitude < mark.interval[1]
        # 0.01 N of noise in 3800 samples: a standard error of 0.23 mN, four of them in an interval
        assert np.ptp(mark.interval) == pytest.approx(4.0 * 0.23, rel=0.25)
    # those outside the axis are not marked
    assert [natural.frequency for natural in marks.naturals] == [3.3]
    assert marks.level_frequency == pytest.approx([float(mark.frequency) for mark in marks.orders])
    # about four standard errors
    assert np.all((marks.level > 0.6) & (marks.level < 1.4))


def test_orders_outside_the_axis_are_not_marked(log: Path) -> None:
    marks = marks_of(analysed(log), span=(0.3, 2.2))
    assert [mark.label.split("  ")[0] for mark in marks.orders] == ["2/3", "1", "3/2", "2", "5/2", "3", "4"]


def test_a_blind_search_marks_its_peaks_and_its_own_level(log: Path, tmp_path: Path) -> None:
    found = analyze(log, asked_options(channels=("Force",)))
    marks = marks_of(found, factor=1000.0)
    assert marks.orders == ()
    assert sorted(frequency for frequency, _ in marks.peaks) == pytest.approx([0.25, 0.5, 1.5], abs=0.02)
    for frequency, amplitude in marks.peaks:
        assert amplitude > np.interp(frequency, marks.level_frequency, marks.level)
    paths, _ = write_analysis(found, tmp_path / "out")
    assert [path.name for path in paths] == ["analysis.md", "analysis.json", "Force-spectrum.png"]


def test_a_record_too_short_for_a_spectrogram_says_so(tmp_path: Path) -> None:
    noise = 0.01 * np.random.default_rng(2).standard_normal(TIME.size)
    log = written(tmp_path / "log.csv", {"Force [N]": cosine(DRIVE, 1.0) + noise}, samples=1190)
    paths, left_out = write_analysis(analysed(log), tmp_path / "out")
    assert not any(path.name.endswith("spectrogram.png") for path in paths)
    (reason,) = left_out
    assert "shorter than 6 periods" in reason
    assert reason in (tmp_path / "out" / "analysis.md").read_text(encoding="utf-8")


def test_the_spectrum_peaks_at_the_amplitude_of_its_line(log: Path) -> None:
    found = analysed(log)
    assert found.window is not None
    seen = spectrum(found.channels[0].channel, found.window)
    assert seen.amplitude[np.argmin(np.abs(seen.frequency - 1.5))] == pytest.approx(0.24, rel=0.02)


def test_a_name_full_of_signs_is_drawn_as_it_stands(tmp_path: Path) -> None:
    """Dollar signs, slashes and letters that a font lacks neither stop a figure nor leave its folder."""
    found = analysed(written(tmp_path / "log.csv", {"../$x_1$ 张力 [N]": cosine(DRIVE, 1.0) + 1e-3 * TIME}))
    paths, _ = write_analysis(found, tmp_path / "out")
    assert {path.parent for path in paths} == {tmp_path / "out"}
    assert sum(path.suffix == ".png" for path in paths) == 3


def test_the_command_writes_and_names_the_files(
    log: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    folder = tmp_path / "out"
    chosen = ["--channel", "Force", "--drive-frequency", "0.5"]
    app(["analyze", str(log), *chosen, "-o", str(folder), "--json"], standalone_mode=False)
    found = json.loads(capsys.readouterr().out)
    assert sorted(found["paths"]) == sorted(str(path) for path in folder.iterdir())


def test_the_run_folder_itself_takes_no_figures(tmp_path: Path) -> None:
    run = Path(__file__).parents[2] / "datasets" / "rig3m" / "run04"
    before = sorted(run.iterdir())
    with pytest.raises(TethertestError, match="raw data only"):
        app(["analyze", str(run), "-o", str(run)], standalone_mode=False)
    assert sorted(run.iterdir()) == before


def test_a_spectrum_without_marks_is_drawn(log: Path) -> None:
    found = analysed(log)
    item, window = found.channels[0], Window(0.0, 30.0)
    none = SpectrumMarks((), (), (), np.empty(0), np.empty(0))
    drawn = spectrum_figure(item, spectrum(item.channel, window), window, none, SPAN)
    assert drawn.png.startswith(b"\x89PNG")
