"""``tethertest inspect`` and ``--set``, as a user types them, and what inspect says of a bare log."""

from __future__ import annotations

import json
import os
import shutil
import sys
import tomllib
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from tethertest.cli import main
from tethertest.errors import TethertestError
from tethertest.jobs.describe_log import described
from tethertest.jobs.inspect import inspect_path, inspected
from tethertest.readers import read_log
from tethertest.readers.config.structure import structure
from tethertest.records.run import Log
from tethertest.render.as_json import as_json

ROOT = Path(__file__).parents[2]
RUN = ROOT / "datasets" / "rig3m" / "run04"
RATE = 200.0

Typed = Callable[..., tuple[int, str, str]]


@pytest.fixture
def typed(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> Typed:
    def run(*words: object) -> tuple[int, str, str]:
        monkeypatch.setattr(sys, "argv", ["tethertest", *map(str, words)])
        with pytest.raises(SystemExit) as left:
            main()
        said = capsys.readouterr()
        return int(left.value.code or 0), said.out, said.err

    return run


def log(path: Path, time: Any, columns: dict[str, Any], digits: int = 3) -> Path:
    """Write a log; NaN becomes an empty cell."""
    rows = [",".join(["t [s]", *columns])]
    for stamp, *values in zip(time, *columns.values(), strict=True):
        cells = ["" if np.isnan(value) else f"{value:.{digits}f}" for value in values]
        rows.append(",".join([f"{stamp:.6f}", *cells]))
    path.write_text("\n".join(rows) + "\n", encoding="utf-8")
    return path


@pytest.fixture
def ambiguous(tmp_path: Path) -> Path:
    rows = "\n".join(f"05/09/2026 10:00:{second:02d},{10 + second % 7}" for second in range(60))
    path = tmp_path / "daq.csv"
    path.write_text("time,F_top\n" + rows + "\n", encoding="utf-8")
    return path


def signal(seconds: float = 20.0, noise: float = 0.02) -> tuple[Any, Any]:
    time = np.arange(round(seconds * RATE)) / RATE
    random = np.random.default_rng(4)
    return time, 10.0 + 3.0 * np.sin(2.0 * np.pi * 0.3 * time) + random.normal(0.0, noise, time.size)


def flags(path: Path) -> dict[str, dict[str, int]]:
    return {channel["name"]: channel["flags"] for channel in as_json(inspect_path(path))["channels"]}


def test_a_log_that_leaves_something_open_is_refused_and_says_what_to_set(
    typed: Typed, ambiguous: Path
) -> None:
    code, out, err = typed("inspect", ambiguous)
    assert (code, out) == (2, "")
    assert err.startswith(f"error: {ambiguous}:2: the date 5/9/... can be read as day/month")
    assert "(or here: --set date_order=VALUE)" in err
    assert "reader: delimited (text that no format reader claims; it begins with 'time,F_top')" in err


@pytest.mark.parametrize(("order", "month"), [("dmy", 9), ("mdy", 5)])
def test_a_setting_answers_it(typed: Typed, ambiguous: Path, order: str, month: int) -> None:
    code, out, err = typed(
        "inspect", ambiguous, "--set", f"date_order={order}", "--set", "units.F_top=kN", "--json"
    )
    said = json.loads(out)
    assert (code, err) == (0, "")
    assert said["refused"] is False
    assert said["start"].startswith(f"2026-{month:02d}-")
    (channel,) = said["channels"]
    assert (channel["unit"], channel["maximum"]) == ("N", 16000.0)


def test_a_wrong_setting_is_an_error_of_the_call_not_of_the_file(typed: Typed, ambiguous: Path) -> None:
    code, out, err = typed("inspect", ambiguous, "--set", "date_order=dym", "--json")
    assert (code, out) == (2, "")
    assert err.startswith("error: --set date_order: found 'dym', expected one of ymd, dmy, mdy")


def test_a_setting_that_the_file_contradicts_is_told_as_the_option(ambiguous: Path) -> None:
    found = as_json(inspected(ambiguous, words=["date_order=dmy", "units.F_bottom=N"]))
    assert found["refused"]
    assert found["message"] == "--set gives a unit for 'F_bottom', which the log does not have"
    found = as_json(inspect_path(ambiguous, words=["date_order=dmy", "format=delimited"]))
    assert "run.toml" not in found["reason"]


def test_settings_are_for_bare_logs(typed: Typed) -> None:
    for command in ("inspect", "analyze"):
        code, _, err = typed(command, RUN, "--set", "date_order=dmy")
        assert code == 2
        assert "--set is for a log that belongs to no run" in err


def test_analyze_takes_the_same_settings(typed: Typed, tmp_path: Path) -> None:
    _, values = signal(40.0)
    path = tmp_path / "bare.csv"
    path.write_text("\n".join(f"{value:.4f};{-value:.4f}" for value in values) + "\n", encoding="utf-8")
    words = ["--set", "columns=F_top,F_bottom", "--set", "rate=200 Hz", "--set", "units.F_top=N"]
    code, out, _ = typed("analyze", path, *words, "--channel", "F_top", "--drive-frequency", "0.3", "--json")
    (channel,) = json.loads(out)["channels"]
    assert code == 0
    assert (channel["name"], channel["unit"]) == ("F_top", "N")
    fundamental = next(line for line in channel["lines"] if line["order"] == "1")
    assert fundamental["amplitude"] == pytest.approx(3.0, rel=0.01)
    code, _, err = typed("analyze", path, "--set", "rates=200 Hz")
    assert (code, err.splitlines()[0]) == (2, "error: --set rates: unknown key")


def test_a_refused_file_is_one_object_with_line_message_and_remedy(typed: Typed, ambiguous: Path) -> None:
    code, out, err = typed("inspect", ambiguous, "--json")
    assert (code, err) == (2, "")
    said = json.loads(out)
    assert (said["path"], said["refused"], said["line"]) == (str(ambiguous), True, 2)
    assert said["format"] == "delimited"
    assert said["reason"].startswith("text that no format reader claims")
    assert said["message"].startswith("the date 5/9/...")
    assert said["remedy"].startswith('set date_order = "dmy" or "mdy"')


def test_a_file_that_no_reader_claims_or_that_is_not_there_is_refused_alike(tmp_path: Path) -> None:
    (tmp_path / "scan.pdf").write_bytes(b"%PDF-1.7\n\x00\x01")
    for name in ("scan.pdf", "none.csv"):
        said = as_json(inspected(tmp_path / name))
        assert (said["refused"], said["format"], said["reason"]) == (True, None, None)
        assert said["message"]
        assert said["remedy"]


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="the system has no named pipes")
def test_a_pipe_is_refused_and_not_waited_for(typed: Typed, tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "pipe")
    for words in ((), ("--set", "decimal=,")):
        assert as_json(inspected(tmp_path / "pipe", words=words[1:]))["message"].startswith("found a pipe")
        code, _, err = typed("analyze", tmp_path / "pipe", *words)
        assert (code, "found a pipe or a device, expected a file" in err) == (2, True)


def test_several_files_are_one_object_a_line_and_one_refusal_is_exit_code_2(
    typed: Typed, ambiguous: Path, tmp_path: Path
) -> None:
    good = log(tmp_path / "good.csv", *_one_channel())
    code, out, _ = typed("inspect", good, ambiguous, good, "--json")
    said = [json.loads(line) for line in out.splitlines()]
    assert code == 2
    assert [item["refused"] for item in said] == [False, True, False]
    assert typed("inspect", good, good, "--json")[0] == 0


def test_one_bad_log_of_a_run_hides_no_other(typed: Typed, tmp_path: Path) -> None:
    shutil.copytree(ROOT / "rigs", tmp_path / "rigs")
    run = tmp_path / "run"
    shutil.copytree(RUN, run)
    (run / "fbg.txt").write_bytes((run / "fbg.txt").read_bytes()[:-40])
    code, out, err = typed("inspect", run, "--json")
    assert json.loads(out)["refused"] is True
    said = json.loads(out)["logs"]
    assert (code, err) == (2, "")
    assert {Path(item["path"]).name: item["refused"] for item in said} == {
        "tension.lvm": False, "fbg.txt": True, "crank.csv": False,
    }  # fmt: skip


def test_the_entry_for_run_toml_is_toml_that_reads_the_log_the_same_way(ambiguous: Path) -> None:
    found = as_json(inspect_path(ambiguous, words=["date_order=mdy", "encoding=utf-8"]))
    (entry,) = tomllib.loads(found["entry"])["log"]
    assert (entry["file"], entry["date_order"], entry["encoding"]) == ("daq.csv", "mdy", "utf-8")
    assert entry["units"] == {"F_top": "TODO"}
    record, problems = structure(Log, entry)
    assert record is not None
    assert not problems


def test_a_page_says_reader_text_clock_units_and_entry(typed: Typed, tmp_path: Path) -> None:
    path = log(tmp_path / "good.csv", *_one_channel())
    code, out, _ = typed("inspect", path)
    assert code == 0
    assert "why this reader: text that no format reader claims" in out
    assert "columns separated by comma, decimal point, names in line 1" in out
    assert "start: not stated in the file" in out
    assert "time: 4000 stamps from 0 to 19.995 s, every 5 ms, even" in out
    assert "[[log]]" in out


def test_remarks_that_say_the_same_of_many_columns_are_one(typed: Typed, tmp_path: Path) -> None:
    time, values = signal(2.0)
    columns = {f"F{number} [N]": values for number in range(5)}
    path = log(tmp_path / "many.csv", time, columns)
    text = path.read_text(encoding="utf-8").splitlines()
    text[7] = text[7].split(",")[0] + ",nan" * 5
    path.write_text("\n".join(text) + "\n", encoding="utf-8")
    _, out, _ = typed("inspect", path)
    assert "5 columns: 1 cells 'nan' read as missing, first in line 8 ('F0', 'F1', 'F2' and 2 more)" in out


def _one_channel() -> tuple[Any, dict[str, Any]]:
    time, values = signal()
    return time, {"F [N]": values}


def test_even_time_is_called_even(tmp_path: Path) -> None:
    (base,) = as_json(inspect_path(log(tmp_path / "a.csv", *_one_channel())))["time_bases"]
    assert base["text"].endswith("every 5 ms, even")
    assert (base["uneven"], base["flags"]) == (
        0, {"missing_time": 0, "duplicate_time": 0, "backward_time": 0, "gap": 0},
    )  # fmt: skip


def test_a_log_with_dropped_rows_everywhere_is_jittered_with_share_and_mean_rate(tmp_path: Path) -> None:
    time, values = signal()
    kept = np.random.default_rng(1).random(time.size) > 0.25
    path = log(tmp_path / "a.csv", time[kept], {"F [N]": values[kept]})
    (base,) = as_json(inspect_path(path))["time_bases"]
    steps = np.diff(time[kept])
    share = np.mean(steps > 1.5 / RATE)
    assert base["uneven"] == np.count_nonzero(steps > 1.5 / RATE)
    assert f"({100 * share:.3g} %) are not that, but 10 ms to " in base["text"]
    assert "all of them whole multiples of it" in base["text"]
    assert base["mean_rate"] == pytest.approx(steps.size / float(np.sum(steps)))
    assert base["mean_rate"] == pytest.approx(0.75 * RATE, rel=0.03)


def test_jitter_of_the_stamps_is_given_in_seconds(tmp_path: Path) -> None:
    time, values = signal()
    path = log(
        tmp_path / "a.csv", time + np.random.default_rng(2).normal(0.0, 8e-5, time.size), {"F [N]": values}
    )
    (base,) = as_json(inspect_path(path))["time_bases"]
    assert base["jitter"] == pytest.approx(np.sqrt(2.0) * 8e-5, rel=0.1)
    assert "jittered by 11" in base["text"]
    assert base["flags"]["gap"] == 0


def test_stamps_that_repeat_are_not_counted_as_uneven_too(tmp_path: Path) -> None:
    time, values = signal()
    time = time.copy()
    time[500:2000:100] = time[499:1999:100]
    (base,) = as_json(inspect_path(log(tmp_path / "a.csv", time, {"F [N]": values})))["time_bases"]
    assert base["flags"]["duplicate_time"] == 15
    assert base["uneven"] == 15  # the steps behind them, twice as long


def test_a_gap_a_repeat_and_a_row_out_of_place_are_each_told_once(tmp_path: Path) -> None:
    time, values = signal()
    kept = (time < 5.0) | (time >= 6.0)
    time, values = time[kept].copy(), values[kept]
    time[2001] = time[2000]
    time[[3000, 3001]] = time[[3001, 3000]]
    (base,) = as_json(inspect_path(log(tmp_path / "a.csv", time, {"F [N]": values})))["time_bases"]
    assert base["flags"] == {"missing_time": 0, "duplicate_time": 1, "backward_time": 1, "gap": 2}
    assert "2 gaps, the longest 1.005 s after 4.995 s" in base["text"]
    assert "1 stamp repeated, at 11" in base["text"]
    assert "1 step backward, to 16" in base["text"]


def test_negative_time_is_seen_as_it_is(tmp_path: Path) -> None:
    time, values = signal()
    (base,) = as_json(inspect_path(log(tmp_path / "a.csv", time - 3.0, {"F [N]": values})))["time_bases"]
    assert (base["first"], base["last"]) == (-3.0, pytest.approx(16.995))


@pytest.mark.parametrize("digit_noise", [0.5, 1.0, 5.0, 20.0])
def test_a_stuck_second_is_counted_at_any_resolution(tmp_path: Path, digit_noise: float) -> None:
    time, values = signal(noise=digit_noise * 0.01)
    still = 5.0 + values - 3.0 * np.sin(2.0 * np.pi * 0.3 * time)
    columns = {"moving [N]": values, "still [N]": still, "stuck [N]": values.copy(), "dead [N]": still.copy()}
    columns["stuck [N]"][1600:2000] = columns["stuck [N]"][1600]
    columns["dead [N]"][3000:] = columns["dead [N]"][3000]
    found = flags(log(tmp_path / "a.csv", time, columns, digits=2))
    assert found["moving"]["stuck"] == found["still"]["stuck"] == 0
    assert found["stuck"]["stuck"] == pytest.approx(400, abs=4)
    assert found["dead"]["stuck"] == pytest.approx(1000, abs=4)


@pytest.mark.parametrize("seed", range(3))
def test_a_slow_signal_in_coarse_digits_is_not_stuck(tmp_path: Path, seed: int) -> None:
    time, _ = signal()
    # the last seconds are so quiet that a digit of 0.1 stays for half a second and longer
    noise = np.random.default_rng(seed).normal(0.0, 1.0, time.size) * np.where(time < 16.0, 0.15, 0.01)
    slow = 20.0 + 0.3 * np.sin(2.0 * np.pi * 0.05 * time) + noise
    assert flags(log(tmp_path / "a.csv", time, {"T [degC]": slow}, digits=1))["T"]["stuck"] == 0


def test_an_amplifier_at_its_limit_is_saturated(tmp_path: Path) -> None:
    time, values = signal()
    found = flags(log(tmp_path / "a.csv", time, {"F [N]": np.minimum(values, 12.0)}))
    assert found["F"]["saturated"] == np.count_nonzero(values >= 12.0 - 5e-4)
    assert found["F"]["stuck"] == 0


def test_a_snap_is_kept_and_a_spike_is_not(tmp_path: Path) -> None:
    time, values = signal()
    snapped, spiked = values.copy(), values.copy()
    # a snap rises over some 10 ms and rings; a spike is one sample
    after = np.clip(time - 8.0, 0.0, None)
    snapped += 60.0 * np.exp(-after / 0.1) * np.sin(2.0 * np.pi * 12.0 * after) * (time > 8.0)
    spiked[[1000, 2500]] += 60.0
    found = flags(log(tmp_path / "a.csv", time, {"snap [N]": snapped, "spike [kg]": spiked}))
    assert found["snap"]["spike"] == 0
    assert found["spike"]["spike"] == 2


def test_a_dead_channel_and_a_state_are_named(tmp_path: Path) -> None:
    time, values = signal()
    columns = {"F [N]": values, "dead [N]": np.full(time.size, 7.0), "phase": (time > 9.0) * 2.0}
    found = as_json(inspect_path(log(tmp_path / "a.csv", time, columns)))
    assert "channel 'dead': constant, all values are 7" in found["remarks"]
    assert any(item.startswith("channel 'phase': changes only 1 times") for item in found["remarks"])
    of = {channel["name"]: channel["flags"] for channel in found["channels"]}
    assert (of["dead"]["stuck"], of["phase"]["stuck"], of["phase"]["saturated"]) == (4000, 0, 0)


@pytest.mark.parametrize(("code", "is_told"), [(-999.0, True), (99999.0, True), (-998.0, False)])
def test_a_number_that_stands_for_no_value_is_told(tmp_path: Path, code: float, is_told: bool) -> None:
    time, values = signal()
    values[[10, 20, 1000]] = code
    remarks = as_json(inspect_path(log(tmp_path / "a.csv", time, {"F [N]": values})))["remarks"]
    assert any(item.startswith(f"channel 'F': 3 values are {code:g}") for item in remarks) is is_told


@pytest.mark.parametrize("scale", [100.0, 70.0])
def test_a_force_of_999_among_or_little_above_others_is_no_code(tmp_path: Path, scale: float) -> None:
    time, values = signal()
    values = np.round(scale * values)
    values[5] = 999.0
    assert not as_json(inspect_path(log(tmp_path / "a.csv", time, {"F [N]": values})))["remarks"]


def test_a_folder_that_is_no_run_is_refused(tmp_path: Path) -> None:
    with pytest.raises(TethertestError, match=r"has no run\.toml"):
        inspect_path(tmp_path)


@pytest.mark.parametrize("absurd", ["1e308", "-1e308", "5e-324", "1e-320", "9e99"])
def test_absurd_numbers_are_described_and_break_nothing(tmp_path: Path, absurd: str) -> None:
    path = log(tmp_path / "a.csv", *_one_channel())
    lines = path.read_text(encoding="utf-8").splitlines()
    for row in (5, 6, 900):
        lines[row] = f"{lines[row].split(',')[0]},{absurd}"
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")
    said = as_json(inspect_path(path))
    beyond = any("3 values are beyond 1e+30" in remark for remark in said["remarks"])
    assert beyond is (abs(float(absurd)) > 1e30)


def test_stamps_that_are_missing_or_infinite_are_counted(tmp_path: Path) -> None:
    read = read_log(log(tmp_path / "a.csv", *_one_channel()))
    (channel,) = read.channels
    time, values = channel.time.copy(), channel.values.copy()
    time[[3, 700]], values[[9, 10]] = np.nan, np.inf
    said = as_json(described(replace(read, channels=(replace(channel, time=time, values=values),)), {}))
    json.dumps(said, allow_nan=False)
    assert said["channels"][0]["flags"]["missing_time"] == 2
    assert said["channels"][0]["flags"]["missing"] == 2
    assert "2 rows without a stamp" in said["time_bases"][0]["text"]
    nowhere = described(replace(read, channels=(replace(channel, time=np.full(time.size, np.nan)),)), {})
    assert nowhere.time_bases[0].text == "0 stamps, no rate"
    assert nowhere.channels[0].rate is None


def test_an_absurd_rate_breaks_nothing(tmp_path: Path) -> None:
    path = tmp_path / "bare.csv"
    path.write_text("\n".join(f"{row};{row % 40 // 20}" for row in range(4000)) + "\n", encoding="utf-8")
    words = ["columns=n,x", "rate=1e300 Hz", "units.x=mm"]
    assert as_json(inspected(path, words=words))["channels"][1]["kind"] == "displacement"
