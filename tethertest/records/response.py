"""What the solver answers: time series at the gauges, the field, and how sure it is."""

from __future__ import annotations

from dataclasses import dataclass
from dataclasses import field as a_field
from enum import Enum
from typing import TYPE_CHECKING, Annotated

from tethertest.records.arrays import FloatArray
from tethertest.records.described import Doc
from tethertest.records.frames import drawn
from tethertest.records.scene import Scene

if TYPE_CHECKING:
    import pandas as pd

    from tethertest.records.frames import Axes


class Status(Enum):
    """Outcome of a solve; the text is advice."""

    OK = "Solved within the stated error."
    UNJUDGED = (
        "Solved, but its error is not known; leave out --cells, or shorten the scene, to have it estimated."
    )
    TOLERANCE_NOT_MET = "The stated error is above the tolerance asked for; allow more cells or ask for less."
    PEAKS_ONLY = (
        "The cable goes slack: the peaks of the 20 ms mean of its tension are within the tolerance, its "
        "course from instant to instant is not; quote these peaks."
    )
    NOT_SETTLED = (
        "The cable goes slack and its answer does not settle as the mesh is refined; give the scene air drag "
        "and axial_damping_time, or quote the spread."
    )
    MODEL_ERROR = (
        "The model leaves out more than the tolerance allows; use --fidelity auto or nonlinear, and for an "
        "upright cable that goes slack quote its model error."
    )
    SLACK_IN_CATENARY = "The quasi-static cable goes slack; use --fidelity nonlinear."
    SLACK_IN_LINEAR = "The cable went slack, which the linear model cannot follow; use --fidelity nonlinear."
    STEP_LIMIT = "The run needs more steps than allowed; shorten the duration or raise the step limit."
    NOT_FINITE = "The solution left the range of numbers; check stiffness, mass and motion of the scene."


@dataclass(frozen=True, slots=True)
class ErrorBudget:
    """Relative errors of the gauges' tension (RMS over the record, of the dynamic part)."""

    numerical: float  #: from a pair of grids
    model: float | None = None  #: against the next fidelity
    spread: float | None = None  #: from unknown damping and straightness when slack
    #: lowest and highest peak over the nominal one, of the members that tell the spread
    peak_range: tuple[float, float] | None = None


@dataclass(frozen=True, slots=True, eq=False)
class SnapPeak:
    """The largest running mean of a slack cable's tension: it settles where instants do not."""

    window: float  #: averaging time [s]
    tension: FloatArray  #: (g,) [N]
    #: numerical, over the largest rise of a peak above rest; None for a cable without drag and damping, whose
    #: peaks do not settle either
    error: float | None


@dataclass(frozen=True, slots=True, eq=False)
class Field:
    """Tension along the cable over time, decimated without losing extremes."""

    time: FloatArray  #: (n,) [s], start of each bin
    position: FloatArray  #: (m,) fraction of the length from the bottom
    maximum: FloatArray  #: (n, m) [N], largest tension within the bin
    minimum: FloatArray  #: (n, m) [N]


@dataclass(frozen=True, slots=True, eq=False)
class Response:
    """A solved scene."""

    scene: Scene
    status: Status
    fidelity: str  #: "catenary", "linear" or "nonlinear"
    scheme: str
    cells: int
    time_step: float  #: [s]
    wall: float  #: [s]
    time: FloatArray  #: (n,) [s]
    gauges: FloatArray  #: (g,) fraction of the length from the bottom
    tension: FloatArray  #: (n, g) [N], total
    strain: FloatArray  #: (n, g), change from rest
    platform_position: FloatArray  #: (n,) [m], from rest, upwards
    field: Field
    error: ErrorBudget
    slack: dict[float, tuple[tuple[float, float], ...]]  #: gauge -> intervals [s]
    warnings: tuple[str, ...] = ()
    #: "position", "velocity" (n, g, 3) along x, y, z and "curvature" (n, g), where the scene asks for them
    fields: dict[str, FloatArray] = a_field(default_factory=dict)
    #: what chose the model and bounds it: frequency ratios, dynamic over static tension, strain
    numbers: dict[str, float] = a_field(default_factory=dict)
    native_times: bool = False  #: `time` holds the scheme's own levels, not t = k/rate
    snap: SnapPeak | None = None  #: of the nonlinear model, where the cable goes slack
    #: (n, g) tension [N] of a slack cable on a coarser mesh: nominal, then with bows and dampings that nobody
    #: knows; empty where they were not run
    members: tuple[FloatArray, ...] = ()

    def to_pandas(self) -> pd.DataFrame:
        """Return tension and strain at the gauges over time [s], named as in the CSV: ``tension_N@0.25``."""
        import pandas as pd

        gauges = [f"{gauge:g}" for gauge in self.gauges]
        named = (("tension_N", self.tension), ("strain", self.strain))
        columns = {f"{name}@{g}": values[:, i] for name, values in named for i, g in enumerate(gauges)}
        return pd.DataFrame(columns, pd.Index(self.time, name="time_s"))

    def plot(self, axes: Axes | None = None) -> Axes:
        """Draw the tension at every gauge, and return the axes."""
        lines = [(self.time, self.tension[:, i], f"at {gauge:g}") for i, gauge in enumerate(self.gauges)]
        return drawn(axes, lines, "tension [N]")


@dataclass(frozen=True, slots=True)
class NaturalFrequency:
    """One natural frequency of the rig with what moves in it."""

    name: Annotated[str, Doc("such as axial 1, lateral 1, pendulum")]
    frequency: Annotated[float, Doc("[Hz]")]


@dataclass(frozen=True, slots=True)
class Modes:
    """Natural frequencies of the linear system about rest."""

    frequencies: tuple[NaturalFrequency, ...]
