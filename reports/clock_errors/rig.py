"""The study's rig as stated and as it truly is: a vertical cable in closed form."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from reports.clock_errors.bar import Bar, bottom_tension_over_motion, standard_uncertainties
from tethertest.records.arrays import FloatArray
from tethertest.records.cable import Cable, Platform, PlatformMode
from tethertest.records.channel import Channel
from tethertest.records.rig import Instrument, Limits, Rig, Sensor
from tethertest.units import Kind

#: gratings stand here, as fractions of the length
PLACES = (0.1, 0.3, 0.5, 0.7, 0.9)
GAUGE_FACTOR = 0.78
#: largest drift between two clocks that the rig calls believable [1]
BELIEVABLE_DRIFT = 1e-4
#: step of the tension that the rig's mechanics expects [s]
EXPECTED_STEP = 2e-3

#: the 3 m rig of rigs/rig3m.toml with its uncertainties
RIG = Rig(
    "study",
    Cable(3.0, "unstretched", 0.0484, 10_020.0, axial_damping_time=1e-4),
    Platform(
        0.4,
        5.0,
        {"hold": PlatformMode(50.0, 5.0), "soft": PlatformMode(20.0, 4.0), "free": PlatformMode()},
    ),
    (
        Sensor("tension_top", "tension", at=1.0),
        Sensor("tension_bottom", "tension", at=0.0),
        Sensor("heave", "displacement", at=0.0),
        *(
            Sensor(f"fbg{number}", "wavelength", at=place, gauge_factor=GAUGE_FACTOR)
            for number, place in enumerate(PLACES, 1)
        ),
    ),
    tuple(Instrument(name, 100.0, BELIEVABLE_DRIFT) for name in ("daq", "interrogator", "encoder")),
    Limits(),
    uncertainty={
        "cable.length": 2e-3,
        "cable.mass_per_length": 3e-4,
        "cable.axial_stiffness": 100.0,
        "cable.axial_damping_time": 5e-5,
        "platform.mass": 2e-3,
        "platform.modes.hold.hover_stiffness": 1.0,
        "platform.modes.hold.hover_damping": 0.1,
        "platform.modes.soft.hover_stiffness": 0.4,
        "platform.modes.soft.hover_damping": 0.1,
    },
)


#: the same rig, known for certain
KNOWN_RIG = replace(RIG, uncertainty=dict.fromkeys(RIG.uncertainty, 0.0))


def stated_bar(mode: str) -> Bar:
    """Return the rig as its file states it."""
    bar = Bar.of(RIG, mode)
    if bar is None:
        message = "the study's rig states its axial stiffness"
        raise ValueError(message)
    return bar


def drawn_bar(random: np.random.Generator, mode: str, rig: Rig) -> Bar:
    """Return the true rig: every parameter off by its stated standard uncertainty times a normal draw."""
    bar = stated_bar(mode)
    changes = {
        name: max(getattr(bar, name) + sigma * random.standard_normal(), 0.0)
        for name, sigma in standard_uncertainties(rig, mode, bar).items()
    }
    return replace(bar, **changes)


@dataclass(frozen=True, slots=True)
class Expected:
    """The bottom tension that the rig as stated makes of a bottom displacement."""

    mode: str

    def __call__(self, heave: Channel) -> Channel:
        """Return it on the displacement's clock, from its first sample to its last."""
        time = np.arange(heave.time[0], heave.time[-1], EXPECTED_STEP)
        height = np.interp(time, heave.time[heave.usable], heave.values[heave.usable])
        values = answered(height, EXPECTED_STEP, stated_bar(self.mode))
        return Channel("expected", Kind.TENSION, "N", time, values, np.zeros(time.size, np.uint16), at=0.0)


def answered(height: FloatArray, step: float, bar: Bar, place: float = 0.0) -> FloatArray:
    """Return the dynamic tension [N] at a place that a bottom displacement [m] makes."""
    from scipy.fft import irfft, next_fast_len, rfft

    size = int(next_fast_len(2 * height.size, real=True))
    bridge = np.linspace(height[-1], height[0], size - height.size + 2)[1:-1]
    spectrum = rfft(np.concatenate((height, bridge)) - height[0])
    frequency = np.asarray(np.fft.rfftfreq(size, step), dtype=np.float64)
    response = bottom_tension_over_motion(bar, frequency, place)
    return np.asarray(irfft(response * spectrum, size)[: height.size], dtype=np.float64)
