"""Mistakes in run files, against their rig and their folder."""

import pytest

from tethertest.errors import RunFileError
from tethertest.readers import load_run

MISTAKES = {
    "mode the rig has not": ('mode = "hold"', 'mode = "hodl"', "platform.mode", "did you mean 'hold'"),
    "clock the rig has not": ('clock = "daq"', 'clock = "dqa"', "log[1].clock", "did you mean 'daq'"),
    "sensor the rig has not": (
        '"tension_top" }',
        '"tension_tip" }',
        "log[1].channels.F_top",
        "did you mean 'tension_top'",
    ),
    "path out of the folder": ('"tension.csv"', '"../tension.csv"', "log[1].file", "inside the run folder"),
    "absolute path": ('"tension.csv"', '"/tmp/tension.csv"', "log[1].file", "inside the run folder"),
    "path of another system": (
        '"tension.csv"',
        "'C:\\logs\\tension.csv'",
        "log[1].file",
        "inside the run folder",
    ),
    "missing log": ('"tension.csv"', '"tensoin.csv"', "log[1].file", "did you mean 'tension.csv'"),
    "missing drive key": ('radius = "0.1 m"\n', "", "drive.radius", "a crank-slider drive needs it"),
    "key of another drive": (
        'radius = "0.1 m"',
        'radius = "0.1 m"\namplitude = "0.1 m"',
        "drive.amplitude",
        "does not belong",
    ),
    "circular frequency": ('"0.3 Hz"', '"1.9 rad/s"', "drive.frequency", "divide by 2 pi"),
    "date without zone": ("+08:00", "", "date", "add the laboratory's zone"),
    "date without time": ("2026-09-05T14:20:00+08:00", "2026-09-05", "date", "a date with time and zone"),
    "window the wrong way": (
        '["0 s", "5 s"]',
        '["5 s", "0 s"]',
        "windows.rest_before",
        "expected the start first",
    ),
    "windows out of order": (
        '["0 s", "5 s"]',
        '["0 s", "25 s"]',
        "windows.steady",
        "before rest_before ends",
    ),
    "excluding an unknown channel": (
        'channel = "tension_top"',
        'channel = "tension"',
        "exclude[1].channel",
        "did you mean 'tension_top'",
    ),
    "exclusion without reason": ('reason = "rig was touched"\n', "", "exclude[1].reason", "is missing"),
    "windows without reason": (
        'reason = "the platform was touched before"\n',
        "",
        "windows.reason",
        "windows set by hand need it",
    ),
    "error of an offset below zero": (
        "[windows]",
        '[override.clock_offset]\ndaq = { value = "1 s", reason = "tap", error = "-1 ms" }\n[windows]',
        "override.clock_offset.daq.error",
        "more than 0 s",
    ),
    "log twice": (
        "[windows]",
        '[[log]]\nfile = "tension.csv"\nclock = "daq"\n[windows]',
        "log[2].file",
        "a second time",
    ),
    "unknown zone": (
        'clock = "daq"',
        'clock = "daq"\ntime_zone = "Mars/Phobos"',
        "log[1].time_zone",
        "expected a time zone",
    ),
    "unknown encoding": (
        'clock = "daq"',
        'clock = "daq"\nencoding = "utf8x"',
        "log[1].encoding",
        "no known encoding",
    ),
    "unknown unit of a channel": (
        'clock = "daq"',
        'clock = "daq"\nunits = { F_top = "kNn" }',
        "log[1].units.F_top",
        "is not known",
    ),
    "offset of an unknown clock": (
        "[windows]",
        '[override.clock_offset]\ndqa = { value = "1 s", reason = "tap" }\n[windows]',
        "override.clock_offset.dqa",
        "did you mean 'daq'",
    ),
    "override without reason": (
        "[windows]",
        '[override.clock_offset]\ndaq = { value = "1 s", reason = "" }\n[windows]',
        "override.clock_offset.daq.reason",
        "found no reason",
    ),
    "crank without radius": ('radius = "0.1 m"', 'radius = "0 m"', "drive.radius", "expected more than 0 m"),
    "crank longer than the cable": ('radius = "0.1 m"', 'radius = "100 m"', "drive.radius", "cable's length"),
    "zone that is none": (
        'clock = "daq"',
        'clock = "daq"\ntime_zone = "+99:00"',
        "log[1].time_zone",
        "a time zone",
    ),
    "name no file can have": (
        '"tension.csv"',
        '"tension\\u0000.csv"',
        "log[1].file",
        "no file can be called",
    ),
    "name too long": ('"tension.csv"', f'"{"x" * 300}.csv"', "log[1].file", "no file can be called"),
    "rig's name too long": ('rig = "bench"', f'rig = "{"x" * 300}"', "rig", "expected the name of a rig"),
    "name of two lines": ('id = "', 'id = "two\\n', "id", "on one line"),
    "rig that is not there": ('rig = "bench"', 'rig = "bensch"', "rig", "did you mean 'bench'"),
    "rig given as a path": ('rig = "bench"', 'rig = "../rigs/bench"', "rig", "expected the name of a rig"),
    "typo in a key": ("[drive]", 'purpse = "validation"\n[drive]', "purpse", "did you mean 'purpose'"),
}


@pytest.mark.parametrize(("old", "new", "key", "words"), MISTAKES.values(), ids=MISTAKES)
def test_a_mistake_is_told_with_file_key_and_remedy(bench, old, new, key, words):
    bench.spoil(bench.run_file, old, new)
    with pytest.raises(RunFileError) as caught:
        load_run(bench.run)
    text = str(caught.value)
    assert text.startswith(str(bench.run_file))
    assert f"{key}: " in text
    assert words in text
    assert "fix: " in text


def test_a_run_has_its_rig_found_upwards(bench):
    run = load_run(bench.run)
    assert run.rig.name == "bench"
    assert run.rig_path.samefile(bench.rig)
    assert run.file.drive.frequency == 0.3
    assert run.file.windows.steady == (20.0, 85.0)
    assert run.file.date.utcoffset().total_seconds() == 8 * 3600


def test_a_run_may_be_given_by_its_file(bench):
    assert load_run(bench.run_file).folder == bench.run


def test_rigs_may_be_elsewhere(bench, tmp_path):
    elsewhere = tmp_path / "elsewhere"
    elsewhere.mkdir()
    bench.rig.rename(elsewhere / "bench.toml")
    with pytest.raises(RunFileError, match="rig: found 'bench'"):
        load_run(bench.run)
    assert load_run(bench.run, elsewhere).rig_path == elsewhere / "bench.toml"


def test_a_mistake_in_the_rig_names_the_rig_file(bench):
    bench.spoil(bench.rig, 'rated = "100 N"', 'rated = "100 mm"')
    with pytest.raises(RunFileError) as caught:
        load_run(bench.run)
    assert caught.value.path.endswith("bench.toml")


def test_a_folder_without_run_file_and_no_folder_at_all_are_told_apart(bench, tmp_path):
    with pytest.raises(RunFileError, match="the run file does not exist"):
        load_run(tmp_path)
    with pytest.raises(RunFileError, match="the run folder does not exist"):
        load_run(tmp_path / "run99")


def test_a_log_in_place_of_a_run_folder_is_told(bench):
    with pytest.raises(RunFileError, match="found a file, expected a run folder"):
        load_run(bench.run / "tension.csv")


def test_a_link_to_itself_is_no_log(bench):
    (bench.run / "tension.csv").unlink()
    (bench.run / "tension.csv").symlink_to("tension.csv")
    with pytest.raises(RunFileError, match="expected a file inside the run folder"):
        load_run(bench.run)


@pytest.mark.parametrize("text", ["a = " + "[" * 5000 + "]" * 5000, "a = " + "9" * 10_000])
def test_what_no_parser_can_hold_is_told(bench, text):
    bench.run_file.write_text(text, encoding="utf-8")
    with pytest.raises(RunFileError, match="too long to read"):
        load_run(bench.run)


def test_a_link_out_of_the_folder_is_a_path_out_of_the_folder(bench, tmp_path):
    (tmp_path / "outside.csv").write_text("t,F\n0,1\n", encoding="utf-8")
    (bench.run / "tension.csv").unlink()
    (bench.run / "tension.csv").symlink_to(tmp_path / "outside.csv")
    with pytest.raises(RunFileError, match="inside the run folder"):
        load_run(bench.run)
