"""A Scene in, a Response out: statics, modes and axial stress waves."""

from tethertest.solver.modal.modes import modes
from tethertest.solver.statics.rest import RestState, rest_state
from tethertest.solver.solve import MESHES, Fidelity, relative_difference, solve

__all__ = ["MESHES", "Fidelity", "RestState", "modes", "relative_difference", "rest_state", "solve"]
