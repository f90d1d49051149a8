"""``tethertest analyze`` on runs and bare logs, and what it refuses."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from tethertest.cli import app
from tethertest.errors import TethertestError
from tethertest.jobs.analysis_options import asked_options
from tethertest.jobs.analyze import analyze
from tethertest.render.analysis import analysis_summary
from tethertest.render.as_json import as_json

CAMPAIGN = Path(__file__).parents[2] / "datasets" / "rig3m"


def written(path: Path, **columns: np.ndarray) -> Path:
    table = np.column_stack(list(columns.values()))
    rows = [",".join("nan" if np.isnan(value) else f"{value:.9g}" for value in row) for row in table]
    path.write_text("\n".join([",".join(columns), *rows]) + "\n", encoding="utf-8")
    return path


@pytest.fixture
def log(tmp_path: Path) -> Path:
    time = np.arange(4000) / 100.0
    noise = 0.01 * np.random.default_rng(1).standard_normal(time.size)
    force = 5.0 + np.cos(2 * np.pi * 0.5 * time) + 0.24 * np.cos(2 * np.pi * 1.5 * time + 0.3) + noise
    return written(
        tmp_path / "log.csv", **{"time [s]": time, "force [N]": force, "still [N]": np.full(time.size, 2.0)}
    )


def test_a_bare_log_gives_the_orders_of_a_named_drive(log: Path) -> None:
    found = as_json(analysis_summary(analyze(log, asked_options(channels=("force",), drive_frequency="0.5"))))
    assert found["drive"]["frequency"] == pytest.approx(0.5, abs=1e-4)
    (channel,) = found["channels"]
    lines = {line["order"]: line for line in channel["lines"]}
    assert lines["1"]["amplitude"] == pytest.approx(1.0, abs=0.002)
    assert lines["3"]["amplitude"] == pytest.approx(0.24, abs=0.002)
    assert lines["3"]["verdict"] == "harmonic"
    assert lines["2"]["verdict"] == "none"
    assert channel["events"] == []
    assert "zero" in channel["no_events"]
    json.dumps(found, allow_nan=False)


def test_without_a_drive_a_blind_search_says_so(log: Path) -> None:
    found = as_json(analysis_summary(analyze(log, asked_options())))
    assert found["drive"] is None
    names = [channel["name"] for channel in found["channels"]]
    assert names == ["force"]  # the constant one is left out, and that is said
    assert any("constant" in note for note in found["notes"])
    strongest = found["channels"][0]["peaks"][0]
    assert strongest["frequency"] == pytest.approx(0.5, abs=0.01)


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"channels": ("torque",)}, "no channel 'torque'; the log has force"),
        ({"channels": ("still",)}, "constant: all 4000 samples are 2"),
        ({"drive_frequency": "60"}, "not below half"),
        ({"drive_frequency": "0.05"}, "periods of 0.05 Hz, expected at least 3"),
        ({"drive_frequency": "0.5", "window": "0:3"}, "hold 1.5 periods"),
        ({"window": "30:90"}, "is not inside the record, 0 to 39.99 s"),
        ({"window": "9:5"}, "is not inside the record"),
        ({"channels": ("force",), "drive_frequency": "2.7"}, "3 steady periods|no drive found"),
        ({"replay": True}, "cannot be replayed"),
    ],
)
def test_what_a_log_cannot_give_is_refused_in_words(
    log: Path, options: dict[str, object], words: str
) -> None:
    with pytest.raises(TethertestError, match=words) as refusal:
        analyze(log, asked_options(**options))  # type: ignore[arg-type]
    assert refusal.value.remedy
    assert str(log) in str(refusal.value)


@pytest.mark.parametrize(
    ("option", "text", "words"),
    [
        ("window", "4-10", "expected START:STOP"),
        ("drive_frequency", "fast", "--drive-frequency"),
        ("mains", "50 kg", "--mains"),
    ],
)
def test_options_that_are_no_quantities(option: str, text: str, words: str) -> None:
    with pytest.raises(TethertestError, match=words):
        asked_options(**{option: text})  # type: ignore[arg-type]


def test_holes_and_short_logs_are_refused(tmp_path: Path) -> None:
    time = np.arange(400) / 100.0
    empty = written(tmp_path / "empty.csv", time=time, force=np.full(400, np.nan), other=np.sin(time))
    with pytest.raises(TethertestError, match="force"):
        analyze(empty, asked_options(channels=("force",)))
    short = written(tmp_path / "short.csv", time=np.arange(2.0), force=np.arange(2.0))
    with pytest.raises(TethertestError, match="2 "):
        analyze(short, asked_options())
    with pytest.raises(TethertestError, match=r"no run\.toml"):
        analyze(tmp_path, asked_options())


def test_a_run_gives_lines_waves_and_fronts() -> None:
    found = as_json(analysis_summary(analyze(CAMPAIGN / "run09", asked_options())))
    truth = json.loads((CAMPAIGN / "run09" / "truth.json").read_text(encoding="utf-8"))
    top = next(channel for channel in found["channels"] if channel["name"] == "tension_top")
    line = next(line for line in top["lines"] if line["order"] == "1")
    assert line["amplitude"] == pytest.approx(truth["orders"]["tension_top"]["1"]["amplitude"], rel=0.003)
    at_section, by_places = (part["orders"][0] for part in found["waves"]["parts"])
    # a free mass takes no mean power: the waves are equal, and two independent ways agree on their size
    assert at_section["energy_ratio"] == pytest.approx(1.0, abs=0.005)
    assert by_places["up"] == pytest.approx(at_section["up"], rel=0.02)
    cable = truth["settings"]["cable"]
    speed = (cable["axial_stiffness_N"] / cable["mass_per_length_kg_per_m"]) ** 0.5
    assert "of an axial wave length" in found["waves"]["remarks"][-1]
    low, high = found["waves"]["speed"]["interval"]
    assert low <= speed
    assert high is None or speed <= high


def test_the_command_prints_tables_and_json(log: Path) -> None:
    from typer.testing import CliRunner

    runner = CliRunner()
    arguments = ["analyze", str(log), "--channel", "force", "--drive-frequency", "0.5"]
    shown = runner.invoke(app, arguments)
    assert shown.exit_code == 0
    assert "harmonic" in shown.stdout
    printed = runner.invoke(app, [*arguments, "--json"])
    assert set(json.loads(printed.stdout)) >= {"drive", "window", "channels", "waves", "notes"}
