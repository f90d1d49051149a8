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
