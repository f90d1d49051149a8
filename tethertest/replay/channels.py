"""Replayed channels: the response read where and when the sensors read."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from tethertest.errors import DataError
from tethertest.records.arrays import BoolArray, FloatArray
from tethertest.records.channel import Channel, Flag, Source
from tethertest.records.response import Response, Status
from tethertest.records.run import Run
from tethertest.replay.motion import BottomMotion, bottom_motion
from tethertest.replay.scene import run_scene
from tethertest.solver import solve
from tethertest.units import Kind

#: mesh of the response that the clock alignment uses; taps need no more
_ALIGNMENT_CELLS = 20


def replayed_channels(
    response: Response, motion: BottomMotion, measured: Sequence[Channel]
) -> tuple[Channel, ...]:
    """Return one replayed channel for each measured tension and strain.

    Parameters
    ----------
    response : Response
        Replay of the run, from the motion's time zero.
    motion : BottomMotion
        What drove it. Where that is not known, the samples are flagged as missing.
    measured : sequence of Channel
        Measured channels on the run's clock; each gives place and times. Times that the replay does not reach
        are left out.

    Raises
    ------
    DataError
        The solve left the range of numbers: what it holds after that is nothing.
    """
    _check_finished(response)
    start = motion.start
    replayed = []
    for channel in measured:
        if channel.kind not in {"tension", "strain"} or channel.at is None:
            continue
        series = response.tension if channel.kind == "tension" else response.strain
        gauge = int(np.argmin(np.abs(response.gauges - channel.at)))
        first, last = np.searchsorted(channel.time, [start, start + response.time[-1]])
        time = channel.time[first:last]
        values = np.interp(time - start, response.time, series[:, gauge])
        answered = _channel(channel, time, values, response.scheme)
        replayed.append(answered.with_flags(_within(time, motion.unknown), Flag.MISSING))
    return tuple(replayed)


def member_channels(
    response: Response, motion: BottomMotion, measured: Sequence[Channel]
) -> tuple[tuple[Channel, ...], ...]:
    """Return `replayed_channels` of each member of a slack cable's replay, the nominal one first.

    They differ by what nobody knows of a slack cable, as how straight it hangs. Their strain is the
    tension's, without the little that damping adds.
    """
    stiffness = response.scene.cable.axial_stiffness
    if stiffness is None:
        return ()
    answers = (
        replace(response, tension=tension, strain=(tension - tension[0]) / stiffness)
        for tension in response.members
    )
    return tuple(replayed_channels(answer, motion, measured) for answer in answers)


def expected_bottom_tension(run: Run) -> Callable[[Channel], Channel]:
    """Return what clock alignment needs: the bottom tension that a bottom displacement calls for.

    The returned function takes the displacement on any clock and answers on the same clock.
    """

    def answer(heave: Channel) -> Channel:
        motion = bottom_motion(heave, frequency=run.file.drive.frequency)
        response = solve(
            run_scene(run, motion.duration),
            measured=motion.motion,
            fidelity="nonlinear",
            cells=_ALIGNMENT_CELLS,
        )
        _check_finished(response)
        time = response.time + motion.start
        answered = _channel(heave, time, response.tension[:, 0], response.scheme)
        return replace(answered, name="expected bottom tension", kind=Kind.TENSION, unit="N", at=0.0)

    return answer


def _within(time: FloatArray, spans: Sequence[tuple[float, float]]) -> BoolArray:
    """Return which times lie in any of the spans."""
    inside = np.zeros(time.size, dtype=np.bool_)
    for start, stop in spans:
        inside[np.searchsorted(time, start) : np.searchsorted(time, stop, "right")] = True
    return inside


def _check_finished(response: Response) -> None:
    if response.status is Status.NOT_FINITE:
        message = f"the replay broke off: {response.status.value}"
        raise DataError(
            message, "correct cable, platform and modes in the rig file, or the unit of the motion"
        )


def _channel(like: Channel, time: FloatArray, values: FloatArray, scheme: str) -> Channel:
    clock = like.source.clock if like.source is not None else ""
    return replace(
        like,
        time=time,
        values=values,
        flags=np.zeros(time.size, dtype=np.uint16),
        uncertainty=0.0,
        noise=0.0,
        source=Source("", "", f"replayed: {scheme}", like.unit, clock),
    )
