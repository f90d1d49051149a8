"""The scene that a run stands for."""

from __future__ import annotations

from dataclasses import replace

from tethertest.errors import DataError
from tethertest.records.rig import Rig
from tethertest.records.run import Run
from tethertest.records.scene import Accuracy, Bottom, Geometry, Output, Scene, Top
from tethertest.solver import FIRST_MESH
from tethertest.solver.nonlinear.chain_march import chain_case

#: relative error that the replay asks of the solver
REPLAY_TOLERANCE = 0.01
#: output rate of the replay [Hz]; a snap on the rig rings at 14 Hz
REPLAY_RATE = 500.0
#: more steps than this on the coarsest mesh mean a wrong rig file: the 3 m rig needs 2e5 a minute
MOST_STEPS = 2e7


def run_scene(run: Run, duration: float, *, rig: Rig | None = None) -> Scene:
    """Return the run's scene, driven by its measured bottom displacement.

    Parameters
    ----------
    run : Run
        Run folder with its rig.
    duration : float
        Length of the replay [s].
    rig : Rig, optional
        Another rig in the place of the run's own, for variations.

    Raises
    ------
    DataError
        The run names a platform mode that the rig does not have, or the rig a cable so short or stiff
        that its waves cannot be followed.
    """
    used = run.rig if rig is None else rig
    mode = used.platform.modes.get(run.file.platform.mode)
    if mode is None:
        message = f"platform mode {run.file.platform.mode!r} is not one of {', '.join(used.platform.modes)}"
        raise DataError(message, "correct [platform] mode in run.toml", path=run.folder / "run.toml")
    places = sorted({0.0, 1.0, *(sensor.at for sensor in used.sensor if sensor.at is not None)})
    scene = Scene(
        name=run.file.title or run.file.id,
        cable=used.cable,
        geometry=Geometry(kind="vertical"),
        bottom=Bottom(motion="measured", direction="vertical"),
        top=Top(
            kind="platform",
            mass=used.platform.mass,
            static_tension=used.platform.static_tension,
            hover_stiffness=mode.hover_stiffness,
            hover_damping=mode.hover_damping,
            drag_area=used.platform.drag_area,
            tilt=used.platform.tilt,
        ),
        output=Output(duration=duration, rate=REPLAY_RATE, gauges=tuple(places)),
        air=used.air,
        accuracy=Accuracy(REPLAY_TOLERANCE),
        gravity=used.gravity,
    )
    still = replace(scene, bottom=Bottom("fixed"))  # the motion itself is not known yet
    steps = chain_case(still, FIRST_MESH).steps
    if steps > MOST_STEPS:
        message = f"a replay of {duration:.4g} s would need {steps:.2g} steps, more than {MOST_STEPS:.2g}"
        remedy = "correct length, mass_per_length and axial_stiffness of the rig's cable"
        raise DataError(message, remedy, path=run.rig_path)
    return scene


def rest_tensions(rig: Rig) -> dict[str, float]:
    """Return the tension at rest [N] at each tension sensor of a vertical rig."""
    weight = rig.cable.mass_per_length * rig.cable.length * rig.gravity
    top = rig.platform.static_tension
    return {
        sensor.name: top - (1.0 - sensor.at) * weight
        for sensor in rig.sensor
        if sensor.kind == "tension" and sensor.at is not None
    }
