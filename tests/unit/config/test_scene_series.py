"""The measured motion that a scene names: what is read, and every way in which it cannot be."""

from dataclasses import replace

import numpy as np
import pytest

from tethertest.errors import TethertestError
from tethertest.readers import load_scene
from tethertest.readers.config.scene_series import read_motion

MOTION = """\
motion = "harmonic"
direction = "vertical"
amplitude = "2 m"
frequency = "0.2 Hz"
start = "ramp"
ramp = "10 s"\
"""
MEASURED = (
    'motion = "measured"\nfile = "heave.csv"\ntime_column = "{}"\ndisplacement_column = "{}"\nunit = "{}"'
)
LVM_HEAD = """\
LabVIEW Measurement\t
Writer_Version\t2
Reader_Version\t2
Separator\tTab
Decimal_Separator\t.
Multi_Headings\tNo
X_Columns\tOne
Time_Pref\tRelative
***End_of_Header***\t
Channels\t1
Samples\t901
Y_Unit_Label\tmm
X_Dimension\tTime
X0\t0.0
Delta_X\t0.05
***End_of_Header***\t
X_Value\theave\tComment
"""
RATE, FREQUENCY = 20.0, 0.2
TIME = np.arange(901) / RATE
HEAVE = 1500.0 * np.sin(2 * np.pi * FREQUENCY * TIME)  # [mm]


def written(rows, names="clock_s,heave_mm"):
    return "\n".join([names, *(",".join(str(cell) for cell in row) for row in rows)]) + "\n"


def rows_of(time=TIME, heave=HEAVE):
    return [[f"{t:.4f}", f"{h:.6f}"] for t, h in zip(time, heave, strict=True)]


@pytest.fixture
def measured(bench):
    """Return what writes the file, asks for it, and reads it."""

    def read(text, time="clock_s", column="heave_mm", unit="mm"):
        bench.spoil(bench.scene, MOTION, MEASURED.format(time, column, unit))
        bench.scene.with_name("heave.csv").write_text(text, encoding="utf-8")
        return read_motion(load_scene(bench.scene))

    return read


def test_the_named_column_is_the_time_and_displacement_counts_from_its_first_row(measured):
    text = written(
        [[f"{h + 7.0:.6f}", i, f"{t + 100.0:.4f}"] for i, (t, h) in enumerate(zip(TIME, HEAVE, strict=True))],
        "heave_mm,time,clock_s",
    )
    motion = measured(text)
    assert motion.time == pytest.approx(TIME, abs=1e-9)
    assert motion.displacement == pytest.approx(HEAVE * 1e-3, abs=1e-8)


@pytest.mark.parametrize(
    ("names", "time", "column", "factor"),
    [
        ("clock [ms],heave [cm]", "clock", "heave", 1000.0),
        ("clock [ms],heave [cm]", "clock [ms]", "heave [cm]", 1000.0),
        ("clock_ms,heave_cm", "clock_ms", "heave_cm", 1000.0),
        ("clock_min,x", "clock_min", "x", 1.0 / 60.0),
    ],
)
def test_the_units_of_the_header_are_those_of_the_data(measured, names, time, column, factor):
    rows = [[repr(t * factor), repr(h / 10.0)] for t, h in zip(TIME.tolist(), HEAVE.tolist(), strict=True)]
    motion = measured(written(rows, names), time, column, "cm")
    assert motion.time == pytest.approx(TIME, abs=1e-9)
    assert motion.displacement == pytest.approx(HEAVE * 1e-3, abs=1e-9)


def test_stamps_are_a_time_column_too(measured):
    rows = [
        [f"2026-09-05 14:{20 + int(t) // 60:02d}:{t % 60:06.3f}", f"{h:.6f}"]
        for t, h in zip(TIME, HEAVE, strict=True)
    ]
    assert measured(written(rows, "when,heave_mm"), "when").time == pytest.approx(TIME, abs=1e-9)


def test_an_instruments_log_gives_its_own_time(bench):
    scene = load_scene(bench.scene)
    log = bench.scene.with_name("heave.lvm")
    log.write_text(
        LVM_HEAD + "\n".join(f"{t:.6f}\t{h:.6f}\t" for t, h in zip(TIME, HEAVE, strict=True)) + "\n",
        encoding="utf-8",
    )
    bottom = replace(
        scene.bottom,
        motion="measured",
        file=str(log),
        time_column="time",
        displacement_column="heave",
        unit="mm",
    )
    motion = read_motion(replace(scene, bottom=bottom))
    assert motion.time == pytest.approx(TIME, abs=1e-9)
    assert motion.displacement == pytest.approx(HEAVE * 1e-3, abs=1e-8)


def changed(row, cells):
    rows = rows_of()
    rows[row] = cells
    return written(rows)


def without(*gone):
    return written([row for index, row in enumerate(rows_of()) if index not in gone])


SPOILED = {
    "hole": (without(*range(400, 404)), r"heave\.csv:402: found a hole of 0\.25 s before this row"),
    "backward": (
        changed(10, ["0.1", "3.0"]),
        r"heave\.csv:12: the time goes backward: found 0\.1 after 0\.45",
    ),
    "duplicate": (changed(10, ["0.4500", "3.0"]), r"heave\.csv:12: the time stands still"),
    "blank displacement": (changed(10, ["0.5", ""]), r"heave\.csv:12: column 'heave_mm' has no number here"),
    "no number": (changed(10, ["0.5", "NaN"]), r"heave\.csv:12: column 'heave_mm' has no number here"),
    "blank time": (changed(10, ["", "3.0"]), r"heave\.csv:12: column 'clock_s' has no number here"),
    "text": (changed(10, ["0.5", "abc"]), r"heave\.csv:12: found 'abc' in column 'heave_mm'"),
    "short row": (changed(10, ["0.5"]), r"heave\.csv:12: found 1 columns, expected 2"),
    "empty": ("", r"heave\.csv: the log is empty"),
    "header alone": ("clock_s,heave_mm\n", r"heave\.csv"),
    "three rows": (written(rows_of()[:3]), r"heave\.csv:1: found 3 rows, expected at least 4"),
    "too short": (written(rows_of()[:790]), r"heave\.csv:791: the record ends 39\.45 s .*expected 40 s"),
    "no displacement": (
        written(rows_of(), "clock_s,heave"),
        r"csv:1: .*displacement_column = 'heave_mm' is not among the columns clock_s, heave",
    ),
    "no time": (written(rows_of(), "clok_s,heave_mm"), r"time_column: did you mean 'clok_s'"),
    "neither": (
        written(rows_of(), "a,b"),
        r"time_column = 'clock_s' and displacement_column = 'heave_mm' .* a, b",
    ),
    "other unit": (written(rows_of(), "clock_s,heave_mm [m]"), r"is in m, but \[bottom\] unit is 'mm'"),
    "other kind": (written(rows_of(), "clock_s,heave_mm [kN]"), r"expected one of displacement"),
    "time in millimetres": (
        written(rows_of(), "clock_s [mm],heave_mm"),
        r"has the unit 'mm', expected one of time",
    ),
    "coarse": (
        written(rows_of(TIME[::20], 1e3 * np.sin(2 * np.pi * 0.2 * TIME[::20]))),
        r"heave\.csv:1: column 'heave_mm' at 1 Hz is too coarse",
    ),
    "noisy": (
        written(rows_of(TIME, HEAVE + np.random.default_rng(1).normal(0.0, 100.0, TIME.size))),
        r"too coarse or too noisy",
    ),
    "cell without a name": (
        written([[*row, "1"] for row in rows_of()]),
        r"heave\.csv",
    ),
    "binary": ("\x00\x01\x02" * 99, r"binary"),
}


@pytest.mark.parametrize(("text", "message"), SPOILED.values(), ids=SPOILED)
def test_a_file_that_cannot_drive_the_cable_is_refused_with_row_and_remedy(measured, text, message):
    with pytest.raises(TethertestError, match=message) as caught:
        measured(text)
    assert "\n  fix: " in str(caught.value)
    assert "run.toml" not in str(caught.value)


@pytest.mark.parametrize(("rows_per_period", "is_enough"), [(7, False), (8, True), (40, True)])
def test_eight_rows_a_period_are_the_fewest(measured, rows_per_period, is_enough):
    time = np.arange(0.0, 45.0, 5.0 / rows_per_period)
    text = written(rows_of(time, 1e3 * np.sin(2 * np.pi * 0.2 * time)))
    if is_enough:
        assert measured(text).time.size == time.size
    else:
        with pytest.raises(TethertestError, match="too coarse"):
            measured(text)


def test_a_record_may_end_one_step_before_the_output(measured):
    assert measured(written(rows_of()[:800])).time[-1] == pytest.approx(39.95)


@pytest.mark.parametrize(
    "as_written",
    [
        lambda text: text.replace("\n", ",\n"),
        lambda text: text.replace(",", ";").replace(".", ","),
        lambda text: "\ufeff" + text.replace("\n", "\r\n"),
        lambda text: text.replace(",", "\t"),
        lambda text: "# a remark\n" + text,
    ],
    ids=["separator at the end", "decimal comma", "Windows", "tabs", "remark"],
)
def test_the_same_motion_is_read_however_the_table_is_written(measured, as_written):
    motion = measured(as_written(written(rows_of())))
    assert motion.time == pytest.approx(TIME, abs=1e-9)
    assert motion.displacement == pytest.approx(HEAVE * 1e-3, abs=1e-8)


def test_a_motion_at_rest_is_a_motion(measured):
    assert not measured(written(rows_of(TIME, 0.0 * HEAVE + 3.0))).displacement.any()
