"""A small rig, run and scene that load, for tests that spoil one thing."""

import pytest

RIG = """\
name = "bench"

[cable]
length = "3 m"
length_state = "unstretched"
mass_per_length = "48.4 g/m"
axial_stiffness = "10 kN"

[platform]
mass = "0.4 kg"
static_tension = "5 N"
modes.hold = { hover_stiffness = "50 N/m" }

[[instrument]]
name = "daq"
rate = "1 kHz"

[[sensor]]
name = "tension_top"
kind = "tension"
at = 1.0
range = ["-10 N", "100 N"]
sensitivity = "2 mV/V"
rated = "100 N"

[[sensor]]
name = "fbg1"
kind = "wavelength"
at = 0.5
expected = "1550 nm"
capture = "2 nm"
gauge_factor = 0.78
thermo_optic = "6.5e-6 1/delta_degC"
expansion = "12e-6 1/delta_degC"
compensation = "temp1"

[[sensor]]
name = "temp1"
kind = "temperature"
expected = "1560 nm"
capture = "2 nm"
thermo_optic = "6.5e-6 1/delta_degC"
noise = "1 pm"

[limits]
peak_tension = "10 %"
"""

RUN = """\
id = "run01"
rig = "bench"
date = 2026-09-05T14:20:00+08:00

[drive]
kind = "crank-slider"
frequency = "0.3 Hz"
radius = "0.1 m"

[platform]
mode = "hold"

[[log]]
file = "tension.csv"
clock = "daq"
channels = { F_top = "tension_top" }

[windows]
rest_before = ["0 s", "5 s"]
steady = ["20 s", "85 s"]
reason = "the platform was touched before"

[[exclude]]
channel = "tension_top"
span = ["41.2 s", "41.9 s"]
reason = "rig was touched"
"""

SCENE = """\
name = "bench scene"

[cable]
length = "150 m"
length_state = "unstretched"
mass_per_length = "48.4 g/m"
axial_stiffness = "10 kN"

[geometry]
kind = "vertical"
tension = "50 N"

[bottom]
motion = "harmonic"
direction = "vertical"
amplitude = "2 m"
frequency = "0.2 Hz"
start = "ramp"
ramp = "10 s"

[top]
kind = "fixed"

[output]
duration = "40 s"
rate = "1 kHz"
gauges = [0.0, 0.5, 1.0]
"""


class Bench:
    """A folder with a rig, a scene and a run; `spoil` changes one text of a file."""

    def __init__(self, root):
        self.rig = root / "rigs" / "bench.toml"
        self.scene = root / "scene.toml"
        self.run = root / "data" / "run01"
        self.run_file = self.run / "run.toml"
        for path, text in ((self.rig, RIG), (self.scene, SCENE), (self.run_file, RUN)):
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(text, encoding="utf-8")
        (self.run / "tension.csv").write_text("t,F_top\n0,5\n", encoding="utf-8")

    @staticmethod
    def spoil(path, old, new):
        text = path.read_text(encoding="utf-8")
        assert text.count(old) >= 1, f"{old!r} is not in {path.name}"
        path.write_text(text.replace(old, new, 1), encoding="utf-8")


@pytest.fixture
def bench(tmp_path):
    return Bench(tmp_path)
