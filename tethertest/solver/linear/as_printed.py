"""The paper's printed scheme (48)-(55), to reproduce its figures and for nothing else.

The trap: it takes the characteristics of both families from the same nodes ``(i +- 1, j - 1)`` with
``ds = ct dt``. The axial wave then runs at ``ct``, not at ``c1``. The scheme is stable and converges, to the
wrong equations: condition 1.1 shows one anomaly at 0.25 Hz and jumps at 0.12-0.13 Hz, as the paper reports,
where the equations have 0.130, 0.193 and 0.260 Hz. No refinement reveals it; the natural frequencies do.

References
----------
Tao & Zhang, Drones 2022, 6(11), 349, equations (48)-(55), their lost signs restored from (42) and (43).
"""

from __future__ import annotations

from tethertest.errors import DataError
from tethertest.kernels.as_printed import march_printed
from tethertest.kernels.two_grid import Tension
from tethertest.records.scene import MeasuredMotion, Scene
from tethertest.solver.linear.two_grid import bottom_velocity, checked_cable, empty_record, solution_of
from tethertest.solver.solution import Solution


def run_as_printed(
    scene: Scene, cells: int, *, measured: MeasuredMotion | None = None, native_times: bool = False
) -> Solution:
    """March a shallow or straight scene with a fixed top once from rest, as the paper prints it.

    Between time levels and nodes the fields are interpolated linearly.

    Parameters
    ----------
    scene : Scene
        Geometry "shallow" or "straight", motion in the plane of the cable. Air drag is left out.
    cells : int
        Number of cells, of both motions.
    measured : MeasuredMotion, optional
        Bottom displacement for ``motion = "measured"``.
    native_times : bool
        Rows at the time levels ``k dt`` instead of at the output rate.

    Raises
    ------
    DataError
        As `run_two_grid`, or the top is not fixed.
    """
    cable = checked_cable(scene, cells)
    if scene.top.kind != "fixed":
        message = f"scene {scene.name!r}: the paper's printed scheme has a fixed top, not {scene.top.kind!r}"
        raise DataError(message, 'set [top] kind = "fixed", or use another scheme')
    cell = cable.length / cells
    step = cell / cable.transverse_speed
    bottom = bottom_velocity(scene, cable, step, measured)
    record = empty_record(scene, (cells, cells), step, bottom.shape[0], native=native_times)
    tension = Tension(cable.tension, cable.axial_stiffness, cable.axial_speed, cable.transverse_speed)
    ratio = cable.axial_speed / cable.transverse_speed
    done = march_printed(bottom, cable.curvature * cell, ratio, tension, (step, cell), record)
    return solution_of(scene, cable, tension, record, (step, done, bottom.shape[0] - 1), measured)
