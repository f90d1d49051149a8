"""What conditioning must be told, because finding it out needs the solver."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field

from tethertest.records.channel import Channel


@dataclass(frozen=True, slots=True)
class Guide:
    """What the rig's mechanics says beforehand; without it the clocks that need it stay unaligned."""

    static_tension: Mapping[str, float] = field(
        default_factory=dict
    )  #: tension sensor -> tension at rest [N]
    #: bottom displacement on any clock -> bottom tension the cable would answer with, on the same clock
    expected_tension: Callable[[Channel], Channel] | None = None
    reference_clock: str = "daq"
    drive_frequency: float | None = None  #: [Hz]; None takes the run file's
    mains: float = 50.0  #: [Hz]
