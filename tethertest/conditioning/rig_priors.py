"""What conditioning must be told beforehand, because finding it out needs the rig's mechanics."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field

from tethertest.records.arrays import FloatArray
from tethertest.records.channel import Channel

#: standard uncertainty of a cable's damping time where the rig file does not state one [s]
UNSTATED_DAMPING_TIME = 5e-4


def no_changes(height: FloatArray, step: float) -> tuple[FloatArray, ...]:
    """Return what a rig that is known for certain changes: nothing."""
    return ()


@dataclass(frozen=True, slots=True)
class RigPriors:
    """What the rig's mechanics says beforehand; without it the clocks that need it stay unaligned."""

    static_tension: Mapping[str, float] = field(
        default_factory=dict
    )  #: tension sensor -> tension at rest [N]
    #: bottom displacement on any clock -> bottom tension the cable would answer with, on the same clock
    expected_tension: Callable[[Channel], Channel] | None = None
    #: bottom displacement (n,) [m] and its step [s] -> what one standard uncertainty of each parameter of the
    #: rig changes in the bottom tension, (n,) [N] each
    tension_changes: Callable[[FloatArray, float], tuple[FloatArray, ...]] = no_changes
    #: frequency [Hz] and place, a fraction of the length -> tension there over bottom displacement [N/m]
    tension_over_motion: Callable[[float, float], float] | None = None
    #: how far from an end of the record with the drive running its motion drives no replay [s]
    motion_reach: float = 0.0
    reference_clock: str = "daq"
    drive_frequency: float | None = None  #: [Hz]; None takes the run file's
    mains: float = 50.0  #: [Hz]
