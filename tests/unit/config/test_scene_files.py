"""Mistakes in scene files."""

import pytest

from tethertest.errors import RunFileError
from tethertest.readers import load_scene

MOTION = """\
motion = "harmonic"
direction = "vertical"
amplitude = "2 m"
frequency = "0.2 Hz"
start = "ramp"
ramp = "10 s"\
"""
MEASURED = (
    'motion = "measured"\nfile = "heave.csv"\ntime_column = "t"\ndisplacement_column = "x"\nunit = "mm"'
)
WIND = '[air]\ndensity = "1.2 kg/m^3"\n{}\n[output]'
PLATFORM = 'kind = "platform"\nmass = "5 kg"\nstatic_tension = "{} N"'
#: weight of the scene's cable, 150 m x 0.0484 kg/m x 9.80665 m/s^2 [N]
WEIGHT = 71.196279

MISTAKES = {
    "missing key of the motion": (
        'amplitude = "2 m"\n',
        "",
        "bottom.amplitude",
        "a harmonic motion needs it",
    ),
    "key of another motion": (
        'amplitude = "2 m"',
        'amplitude = "2 m"\nradius = "1 m"',
        "bottom.radius",
        "does not belong",
    ),
    "ramp without duration": ('ramp = "10 s"\n', "", "bottom.ramp", "needs its duration"),
    "duration without ramp": ('start = "ramp"\n', "", "bottom.ramp", 'beside start = "jump"'),
    "missing motion file": (MOTION, MEASURED, "bottom.file", "no such file beside the scene"),
    "zero direction": ('"vertical"\namp', "[0.0, 0.0]\namp", "bottom.direction", "vector of zeros"),
    "direction of four": (
        '"vertical"\namp',
        "[0.0, 1.0, 0.0, 0.0]\namp",
        "bottom.direction",
        "expected 2 or 3",
    ),
    "unknown direction": (
        '"vertical"\namp',
        '"upwards"\namp',
        "bottom.direction",
        "tangent, vertical, horizontal",
    ),
    "no tension at all": ('tension = "50 N"\n', "", "geometry.tension", "a vertical cable needs it"),
    "key of another geometry": (
        'tension = "50 N"',
        'tension = "50 N"\ntop = ["1 m", "2 m"]',
        "geometry.top",
        "does not belong",
    ),
    "ends without a top": (
        'kind = "vertical"\ntension = "50 N"',
        'kind = "ends"',
        "geometry.top",
        "needs it",
    ),
    "hovering without platform": (
        'kind = "vertical"\ntension = "50 N"',
        'kind = "hovering"',
        "top.kind",
        "expected a platform",
    ),
    "mass of a fixed top": (
        'kind = "fixed"',
        'kind = "fixed"\nmass = "5 kg"',
        "top.mass",
        "does not belong to a fixed top",
    ),
    "hold of a fixed top": (
        'kind = "fixed"',
        'kind = "fixed"\nhover_stiffness = "5 N/m"',
        "top.hover_stiffness",
        "does not belong",
    ),
    "platform without mass": ('kind = "fixed"', 'kind = "platform"', "top.mass", "a platform needs it"),
    "lift and tension": (
        'kind = "fixed"',
        PLATFORM.format(WEIGHT + 50) + '\nlift = "9 N"',
        "top.lift",
        "one of the two",
    ),
    "tensions at odds": (
        'kind = "fixed"',
        PLATFORM.format(100),
        "geometry.tension",
        "makes 121.2 N at the top, but top.static_tension is 100 N",
    ),
    "gauge off the cable": ("[0.0, 0.5, 1.0]", "[0.0, 1.5]", "output.gauges[2]", "expected at most 1"),
    "no gauge": ("[0.0, 0.5, 1.0]", "[]", "output.gauges", "found no gauge"),
    "gauge twice": ("[0.0, 0.5, 1.0]", "[0.5, 0.5]", "output.gauges", "a gauge twice"),
    "drag without diameter": (
        "[output]",
        '[air]\ndensity = "1.2 kg/m^3"\nnormal_drag = 1.2\n[output]',
        "cable.diameter",
        "[air] gives the cable drag",
    ),
    "one wind component": (
        "[output]",
        '[air]\ndensity = "1.2 kg/m^3"\nwind = ["3 m/s"]\n[output]',
        "air.wind",
        "expected 2 or 3",
    ),
    "wind of forces": (
        "[output]",
        '[air]\ndensity = "1.2 kg/m^3"\nwind = ["3 m/s", "1 N"]\n[output]',
        "air.wind[2]",
        "expected a quantity in m/s",
    ),
    "zero stiffness": (
        'axial_stiffness = "10 kN"',
        'axial_stiffness = "0 N"',
        "cable.axial_stiffness",
        "more than 0",
    ),
    "negative mass": ('"48.4 g/m"', '"-48.4 g/m"', "cable.mass_per_length", "expected more than 0 kg/m"),
    "zero length": ('length = "150 m"', 'length = "0 m"', "cable.length", "expected more than 0 m"),
    "platform of no mass": (
        'kind = "fixed"',
        'kind = "platform"\nmass = "0 kg"\nstatic_tension = "121.196279 N"',
        "top.mass",
        "expected more than 0 kg",
    ),
    "lift at odds with the tension": (
        'kind = "fixed"',
        'kind = "platform"\nmass = "5 kg"\nlift = "100 N"',
        "geometry.tension",
        "top.lift less the platform's weight is 50.97 N",
    ),
    "vectors of one": (
        'kind = "vertical"\ntension = "50 N"',
        'kind = "ends"\ntop = ["9 m"]',
        "geometry.top",
        "expected 2 or 3",
    ),
    "top at the bottom": (
        'kind = "vertical"\ntension = "50 N"',
        'kind = "ends"\ntop = ["0 m", "0 m"]',
        "geometry.top",
        "the bottom end itself",
    ),
    "gauges of one name": ("[0.0, 0.5, 1.0]", "[0.5, 0.50000001]", "output.gauges", "a gauge twice"),
    "field twice": (
        "[output]",
        '[output]\nfields = ["position", "position"]',
        "output.fields",
        "a field twice",
    ),
    "unknown field": (
        "[output]",
        '[output]\nfields = ["positon"]',
        "output.fields[1]",
        "did you mean 'position'",
    ),
    "rows too far apart": (
        '"1 kHz"',
        '"0.3 Hz"',
        "output.rate",
        "at least 0.42 Hz, above twice the drive's frequency",
    ),
    "one row": ('"40 s"', '"0.5 ms"', "output.rate", "no row but the first"),
    "too many values": ('"1 kHz"', '"1 MHz"', "output.rate", "2.4e+08 values, expected at most 5e+07"),
    "infinitely many values": ('"40 s"', '"1e300 s"', "output.rate", "expected at most 5e+07"),
    "zero tolerance": (
        "[output]",
        "[accuracy]\ntolerance = 0\n[output]",
        "accuracy.tolerance",
        "more than 0",
    ),
    "tolerance above one": (
        "[output]",
        "[accuracy]\ntolerance = 2\n[output]",
        "accuracy.tolerance",
        "at most 1",
    ),
    "motion file out of the folder": (
        MOTION,
        MEASURED.replace("heave.csv", "../heave.csv"),
        "bottom.file",
        "inside the scene's folder",
    ),
    "motion file from the root": (
        MOTION,
        MEASURED.replace("heave.csv", "/etc/passwd"),
        "bottom.file",
        "inside the scene's folder",
    ),
    "motion file of no name": (
        MOTION,
        MEASURED.replace("heave.csv", "x" * 300),
        "bottom.file",
        "no file can be",
    ),
    "time as displacement": (
        MOTION,
        MEASURED.replace('"x"', '"t"'),
        "bottom.displacement_column",
        "also the time_column",
    ),
    "displacement of force": (
        MOTION,
        MEASURED.replace('"mm"', '"kN"'),
        "bottom.unit",
        "expected one of displacement",
    ),
    "missing wind file": (
        "[output]",
        WIND.format('wind_file = "gust.csv"'),
        "air.wind_file",
        "no such file beside",
    ),
    "wind file out of the folder": (
        "[output]",
        WIND.format('wind_file = "../gust.csv"'),
        "air.wind_file",
        "inside the scene's folder",
    ),
    "wind and wind file": (
        "[output]",
        WIND.format('wind = "3 m/s"\nwind_file = "gust.csv"'),
        "air.wind",
        "found beside wind_file",
    ),
    "unknown table": ("[output]", "[outptu]", "outptu", "did you mean 'output'"),
}


@pytest.mark.parametrize(("old", "new", "key", "words"), MISTAKES.values(), ids=MISTAKES)
def test_a_mistake_is_told_with_file_key_and_remedy(bench, old, new, key, words):
    bench.spoil(bench.scene, old, new)
    with pytest.raises(RunFileError) as caught:
        load_scene(bench.scene)
    text = str(caught.value)
    assert text.startswith(str(bench.scene))
    assert f"{key}: " in text
    assert words in text
    assert "fix: " in text


@pytest.mark.parametrize(("kind", "held"), [("straight", 60), ("shallow", 49), ("shallow", 62)])
def test_the_tension_of_a_level_cable_at_odds_with_the_platforms_is_told(bench, kind, held):
    bench.spoil(bench.scene, '"vertical"', f'"{kind}"')
    bench.spoil(bench.scene, 'kind = "fixed"', PLATFORM.format(held))
    with pytest.raises(RunFileError, match=rf"geometry\.tension: .*top\.static_tension is {held} N"):
        load_scene(bench.scene)


@pytest.mark.parametrize("held", [50.0, 61.37])  # the chord's tension, and with half the weight at each end
def test_a_shallow_cables_end_may_hold_the_tension_of_either_model(bench, held):
    bench.spoil(bench.scene, '"vertical"', '"shallow"')
    bench.spoil(bench.scene, 'kind = "fixed"', PLATFORM.format(held))
    assert load_scene(bench.scene).top.static_tension == held


def test_both_tensions_may_be_given_where_they_agree(bench):
    bench.spoil(bench.scene, 'kind = "fixed"', PLATFORM.format(f"{WEIGHT + 50:.6f}"))
    assert load_scene(bench.scene).top.static_tension == pytest.approx(WEIGHT + 50)


def test_a_measured_motion_is_found_beside_the_scene(bench, monkeypatch, tmp_path):
    bench.spoil(bench.scene, MOTION, MEASURED)
    heave = bench.scene.with_name("heave.csv")
    heave.write_text("t,x\n0,0\n", encoding="utf-8")
    (tmp_path / "data").mkdir(exist_ok=True)
    monkeypatch.chdir(tmp_path / "data")
    assert load_scene("../scene.toml").bottom.file == "../heave.csv"


def test_values_are_si_and_defaults_are_the_documented_ones(bench):
    scene = load_scene(bench.scene)
    assert scene.cable.mass_per_length == pytest.approx(0.0484)
    assert scene.output.rate == 1000.0
    assert scene.gravity == 9.80665
    assert scene.cable.axial_damping_time is None
    assert scene.air is None
