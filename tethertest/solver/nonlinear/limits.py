"""The largest time step that a march may take."""

from __future__ import annotations

import math

from tethertest.kernels.march import Line, UpperEnd

#: limited linear viscosity; the slack law needs a scheme that loses energy at fronts
VISCOSITY = 0.1
#: distance kept from the stability limit where anything but the axial wave sets it
_MARGIN = 0.995
#: explicit damping is worth its steps up to this ``t_d c / h``; above, it is solved for
EXPLICIT_DAMPING = 1.0


def courant_limit(line: Line, top: UpperEnd, air_speed: float = 0.0) -> float:
    """Return the largest stable Courant number of the axial wave.

    ``(1 + b + e) s^2 + 2 a s <= 1``: a is the damping that acts on the shortest wave (viscosity, explicit
    Kelvin-Voigt and drag), b bending, e the position loop of the body; each is a bound on its part of the
    largest eigenvalue.

    Parameters
    ----------
    line, top : Line, UpperEnd
    air_speed : float
        Largest speed between cable and air that is expected [m/s].
    """
    wave_speed = math.sqrt(line.stiffness / line.mass)
    damping_time = 0.0 if line.implicit > 0.0 else line.damping_time
    drag = max(line.normal_drag, line.tangential_drag)
    a = line.viscosity + damping_time * wave_speed / line.cell
    a += 0.5 * drag * air_speed * line.cell / (line.mass * wave_speed)
    b = 4.0 * line.bending / (line.stiffness * line.cell**2)
    e = 0.0
    if not top.fixed:
        end_mass = top.mass + 0.5 * line.mass * line.cell
        e = float(max(top.stiffness)) * line.cell**2 / (4.0 * wave_speed**2 * end_mass)
    if a == 0.0 and b == 0.0 and e == 0.0:
        return 1.0
    stiff = 1.0 + b + e
    return _MARGIN * (-a + math.sqrt(a * a + stiff)) / stiff
