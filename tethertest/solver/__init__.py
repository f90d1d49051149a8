"""A Scene in, a Response out: statics, modes, quasi-static, linear and nonlinear cables."""

from tethertest.solver.linear.refine import LinearScheme
from tethertest.solver.modal.modes import modes
from tethertest.solver.nonlinear.refine import FIRST_MESH
from tethertest.solver.norms import relative_difference
from tethertest.solver.solve import Fidelity, solve
from tethertest.solver.statics.rest import RestState, rest_state

__all__ = [
    "FIRST_MESH",
    "Fidelity",
    "LinearScheme",
    "RestState",
    "modes",
    "relative_difference",
    "rest_state",
    "solve",
]
