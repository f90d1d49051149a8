"""What is attributed and kept of a random log."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from reports.lost_gratings.cases import RATE, Case
from tethertest.conditioning.gratings.assignment import assigned
from tethertest.records.channel import Channel, Flag
from tethertest.units import Kind


@dataclass(frozen=True, slots=True)
class Outcome:
    """What became of a case, in samples."""

    case: Case
    visible: int
    kept: int
    wrong: int  #: values that are another grating's
    ghosts_taken: int  #: values that are no grating's
    lost: int
    unflagged: int  #: samples without a value and without a flag


def judge(case: Case) -> Outcome:
    """Assign the peaks of a case and compare every value with what was put in."""
    time = np.arange(case.columns.shape[0]) / RATE
    numbered = case.layout == "numbered peaks"
    names = [
        f"CH1 peak{number + 1}" if numbered or number >= len(case.rig.sensor) else f"g{number + 1}"
        for number in range(case.columns.shape[1])
    ]
    logged = [
        Channel(name, Kind.WAVELENGTH, "m", time, values, np.zeros(time.size, np.uint16))
        for name, values in zip(names, case.columns.T, strict=True)
    ]
    found = {channel.name: channel for channel in assigned(logged, case.rig)[0]}
    visible = np.isfinite(case.true)
    kept = wrong = ghosts = unflagged = 0
    for number, sensor in enumerate(case.rig.sensor):
        channel = found.get(sensor.name)
        if channel is None:
            continue
        given = np.isfinite(channel.values)
        right = given & (channel.values == case.true[:, number])
        others = given & ~right & (channel.values[:, None] == case.true).any(axis=1)
        kept += int(np.count_nonzero(right))
        wrong += int(np.count_nonzero(others))
        ghosts += int(np.count_nonzero(given & ~right & ~others))
        unflagged += int(np.count_nonzero(~given & ((channel.flags & np.uint16(Flag.LOST)) == 0)))
    total = int(np.count_nonzero(visible))
    return Outcome(case, total, kept, wrong, ghosts, visible.size - total, unflagged)
