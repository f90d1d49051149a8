"""Every mistake a technician makes: exit code 2, one message with its remedy, nothing written."""

from __future__ import annotations

import re
import shutil
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

from tethertest.cli import main

ROOT = Path(__file__).parents[2]
GOOD_RUN = ROOT / "datasets" / "rig3m" / "run04"
QUIET_RUN = ROOT / "datasets" / "rig3m" / "run01"


@pytest.fixture
def run(tmp_path: Path) -> Path:
    """A run folder that may be spoiled, with its rig beside it."""
    shutil.copytree(ROOT / "rigs", tmp_path / "rigs")
    folder = tmp_path / "run"
    shutil.copytree(GOOD_RUN, folder)
    return folder


def edit(path: Path, change: Callable[[str], str]) -> None:
    path.write_bytes(change(path.read_bytes().decode("utf-8")).encode("utf-8"))


def replace(old: str, new: str) -> Callable[[str], str]:
    def change(text: str) -> str:
        assert old in text
        return text.replace(old, new, 1)

    return change


def missing_log(run: Path) -> None:
    (run / "crank.csv").unlink()


def empty_log(run: Path) -> None:
    (run / "fbg.txt").write_bytes(b"")


def log_cut_in_a_row(run: Path) -> None:
    edit(run / "fbg.txt", lambda text: text[:-40])


def spectrum_in_the_place_of_a_log(run: Path) -> None:
    head = "Wavelength Start (nm):\t1460.00000\nWavelength Delta (pm):\t8.0\nNumber of Points:\t20000\n"
    (run / "fbg.txt").write_text(head + "\n".join(f"{-60 + i % 7}" for i in range(500)), encoding="utf-8")


def unknown_unit(run: Path) -> None:
    edit(run / "crank.csv", replace("heave [mm]", "heave [furlongs2]"))


def wrong_dimension(run: Path) -> None:
    edit(run / "crank.csv", replace("heave [mm]", "heave [kN]"))


def ambiguous_comma(run: Path) -> None:
    rows = "\n".join(f"{i};1,{234 + i % 7}" for i in range(400))
    (run / "crank.csv").write_text("time [s];heave [mm]\n" + rows + "\n", encoding="utf-8")


def ambiguous_date(run: Path) -> None:
    edit(run / "crank.csv", lambda text: text.replace("2026-09-05", "05/09/2026"))


def backward_time(run: Path) -> None:
    def swap(text: str) -> str:
        lines = text.splitlines(keepends=True)
        return "".join([lines[0], *lines[6001:], *lines[1:6001]])

    edit(run / "crank.csv", swap)


def no_rest_window(run: Path) -> None:
    for name, header in (("crank.csv", 1), ("fbg.txt", 7)):
        lines = (run / name).read_bytes().splitlines(keepends=True)
        first, last = (4600, 7600) if name == "crank.csv" else (2300, 3800)
        (run / name).write_bytes(b"".join([*lines[:header], *lines[header + first : header + last]]))


def no_drive(run: Path) -> None:
    settings = (run / "run.toml").read_bytes()
    for log in run.iterdir():
        log.unlink()
    for log in QUIET_RUN.iterdir():
        shutil.copy(log, run / log.name)
    date = next(line for line in (run / "run.toml").read_text().splitlines() if line.startswith("date"))
    (run / "run.toml").write_bytes(settings)
    edit(
        run / "run.toml",
        lambda text: "\n".join(date if line.startswith("date") else line for line in text.splitlines()),
    )


def channels_that_never_overlap(run: Path) -> None:
    edit(run / "crank.csv", lambda text: text.replace("2026-09-05", "2024-01-17"))


def typo_in_the_rig(run: Path) -> None:
    edit(run.parent / "rigs" / "rig3m.toml", replace("axial_stiffness", "axial_stifness"))


def unknown_mode(run: Path) -> None:
    edit(run / "run.toml", replace('mode = "soft"', 'mode = "sotf"'))


def path_out_of_the_folder(run: Path) -> None:
    edit(run / "run.toml", replace('file = "crank.csv"', 'file = "../crank.csv"'))


def channel_not_in_the_log(run: Path) -> None:
    edit(run / "run.toml", replace("F_top =", "F_tap ="))


def encoder_in_metres(run: Path) -> None:
    edit(run / "crank.csv", replace("heave [mm]", "heave [m]"))


def dead_load_cell(run: Path) -> None:
    def blank(text: str) -> str:
        head, values = text.split("X_Value", 1)
        names, *rows = values.splitlines()
        rows = ["\t".join([row.split("\t")[0], "NaN", row.split("\t")[2]]) for row in rows if row]
        return "\n".join([f"{head}X_Value{names}", *rows, ""])

    edit(run / "tension.lvm", blank)


def limit_without_percent(run: Path) -> None:
    edit(run.parent / "rigs" / "rig3m.toml", replace('peak_tension = "10 %"', "peak_tension = 10"))


CASES: dict[Callable[[Path], None], str] = {
    missing_log: r"crank\.csv.*no such file",
    empty_log: r"fbg\.txt.*empty",
    log_cut_in_a_row: r"fbg\.txt:\d+: the last row is cut",
    spectrum_in_the_place_of_a_log: r"fbg\.txt.*spectrum",
    unknown_unit: r"crank\.csv.*furlongs2",
    wrong_dimension: r"crank\.csv.*kN.*displacement",
    ambiguous_comma: r"crank\.csv.*decimal",
    ambiguous_date: r"crank\.csv.*date_order",
    backward_time: r"crank\.csv.*backward",
    no_rest_window: r"no rest",
    no_drive: r"no drive found",
    channels_that_never_overlap: r"crank\.csv.*2024",
    typo_in_the_rig: r"rig3m\.toml.*axial_stifness.*did you mean",
    unknown_mode: r"sotf.*soft",
    path_out_of_the_folder: r"inside the run folder",
    channel_not_in_the_log: r"F_tap.*F_top",
    encoder_in_metres: r"crank\.csv.*'heave', logged as m, lies beyond its range",
    dead_load_cell: r"tension\.lvm: no sample of 'tension_top' can be used.*missing",
    limit_without_percent: r"rig3m\.toml:\d+: limits\.peak_tension.*at most 1",
}


def report(run: Path, output: Path, monkeypatch: pytest.MonkeyPatch) -> int:
    monkeypatch.setattr(sys, "argv", ["tethertest", "report", str(run), "-o", str(output)])
    with pytest.raises(SystemExit) as left:
        main()
    return int(left.value.code or 0)


@pytest.mark.parametrize("spoil", list(CASES), ids=lambda case: case.__name__)
def test_bad_input_is_one_message_with_a_remedy_and_nothing_written(
    spoil: Callable[[Path], None],
    run: Path,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    spoil(run)
    output = tmp_path / "out"
    assert report(run, output, monkeypatch) == 2
    said = capsys.readouterr()
    assert said.out == ""
    assert said.err.startswith("error: ")
    assert "Traceback" not in said.err
    assert "fix: " in said.err
    assert re.search(CASES[spoil], said.err, re.DOTALL), said.err
    assert not output.exists()


def test_two_readers_that_claim_one_file_are_named(
    run: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    from tethertest.readers import registry
    from tethertest.readers.formats import catman, lvm

    monkeypatch.setattr(catman, "sniff", lvm.sniff)
    assert registry.READERS
    assert report(run, tmp_path / "out", monkeypatch) == 2
    said = capsys.readouterr().err
    assert "lvm" in said
    assert "catman" in said
    assert "fix: " in said


def test_an_output_folder_that_is_a_file_is_refused(
    run: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    output = tmp_path / "taken"
    output.write_text("mine", encoding="utf-8")
    assert report(run, output, monkeypatch) == 2
    assert "fix: " in capsys.readouterr().err
    assert output.read_text(encoding="utf-8") == "mine"


def test_the_run_folder_is_no_output_folder(
    run: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    before = sorted(run.iterdir())
    assert report(run, run, monkeypatch) == 2
    assert "raw data only" in capsys.readouterr().err
    assert sorted(run.iterdir()) == before


def test_an_output_folder_that_cannot_be_made_is_refused(
    run: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    assert report(run, Path("/proc/report"), monkeypatch) == 2  # not even root writes there
    assert "fix: " in capsys.readouterr().err


def test_comma_decimals_are_read_right_when_nothing_is_ambiguous(run: Path) -> None:
    from tethertest.readers import read_log

    path = run / "crank.csv"
    plain = read_log(path).channels[0].values
    edit(path, lambda text: text.replace(".", ","))
    comma = read_log(path)
    assert comma.decimal == ","
    assert (comma.channels[0].values == plain).all()
