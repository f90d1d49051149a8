"""Waves of a run: fronts of the knocks at rest, parts going up and down, the largest tension."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Final

import numpy as np

from tethertest.errors import DataError
from tethertest.records.analysis import MEASURED, REPLAYED, WaveFindings
from tethertest.records.channel import Channel, ConditionedRun, Window
from tethertest.records.events import Front, WaveSpeed
from tethertest.records.lines import ChannelLines, DriveFit, Event, EventKind, Expectation
from tethertest.records.response import Response
from tethertest.records.rig import Rig
from tethertest.records.scene import Scene
from tethertest.records.waves import LargestTension, Waves
from tethertest.solver import rest_state
from tethertest.spectra import find_lines
from tethertest.spectra.arrivals import find_front
from tethertest.spectra.wave_speed import wave_speed
from tethertest.spectra.waves import Medium, Station, section_waves, separated_waves
from tethertest.units import Kind

#: the front of a knock is looked for from this long after a rest window's start [s]
SETTLE: Final = 0.2
#: fronts of one knock lie within this many axial traverses and sampling intervals of the slowest sensor
SPAN: Final = 2.0
#: a gauge this near to a station of the field is at it, fraction of the length
SAME_PLACE: Final = 1e-9
#: a cable shorter than this share of a wave length moves as one
SHORT: Final = 0.05
#: kinds of channels that see an axial wave
FORCES: Final = ("tension", "strain")


def medium_of(scene: Scene, rig: Rig) -> Medium:
    """Return the cable of a run as waves see it, with the rig file's uncertainties."""
    rest = rest_state(scene)
    stiffness = rig.uncertainty.get("cable.axial_stiffness", 0.0) / rest.axial_stiffness
    mass = rig.uncertainty.get("cable.mass_per_length", 0.0) / rest.mass_per_length
    share = 0.5 * math.hypot(stiffness, mass)
    impedance = math.sqrt(rest.axial_stiffness * rest.mass_per_length)
    return Medium(impedance, rest.wave_speed, rest.length, share, share)


def pattern_remarks(findings: WaveFindings, medium: Medium, frequency: float) -> tuple[str, ...]:
    """Say where waves were separated although the cable is too short for a pattern of them.

    Parameters
    ----------
    findings : WaveFindings
        Measured or replayed.
    medium : Medium
        The cable.
    frequency : float
        Of the drive [Hz].
    """
    share = medium.length * frequency / medium.speed
    if share > SHORT or not findings.parts:
        return ()
    text = f"the cable is {share:.2g} of an axial wave length at the drive's frequency"
    return (f"{text}: the ratio of its waves tells how the top yields, and there is no pattern along it",)


def measured_waves(
    measured: ConditionedRun,
    lines: Sequence[ChannelLines],
    events: Sequence[Event],
    window: Window | None,
    scene: Scene,
    rig: Rig,
) -> WaveFindings:
    """Return what the sensors of a run tell of waves.

    Parameters
    ----------
    measured : ConditionedRun
        Its rest window holds the knocks.
    lines : sequence of ChannelLines
        Lines of its channels in the window.
    events : sequence of Event
        Slack, which forbids to superpose waves.
    window : Window or None
        The steady part.
    scene : Scene
        The replayed scene, for the cable at rest.
    rig : Rig
        For the uncertainties.
    """
    medium = medium_of(scene, rig)
    fronts, speed, remarks = _knock(measured, medium, rig)
    slack = [
        e
        for e in events
        if e.kind == EventKind.SLACK and window and e.start < window.stop and e.stop > window.start
    ]
    if slack:
        names = ", ".join(sorted({event.channel for event in slack}))
        remarks.append(
            f"the cable goes slack in the window ({names}): waves do not superpose, none separated"
        )
        return WaveFindings(fronts, speed, remarks=tuple(remarks))
    parts: list[Waves] = []
    by_name = {found.channel: found for found in lines}
    motion = next((c for c in measured.channels if c.kind == "displacement" and c.at == 0.0), None)
    bottom = next((c for c in measured.channels if c.kind == "tension" and c.at == 0.0), None)
    if motion is not None and bottom is not None and motion.name in by_name and bottom.name in by_name:
        orders = section_waves(
            _station(bottom, by_name[bottom.name], measured, scene),
            _station(motion, by_name[motion.name], measured, scene),
            medium,
        )
        parts.append(Waves(MEASURED, f"{bottom.name} and {motion.name}", 0.0, orders))
    stations = [
        _station(channel, by_name[channel.name], measured, scene)
        for channel in measured.channels
        if channel.kind in FORCES and channel.at is not None and channel.name in by_name
    ]
    if len({station.at for station in stations}) > 1:
        names = ", ".join(station.lines.channel for station in stations)
        lowest = min(station.at for station in stations)
        parts.append(Waves(MEASURED, names, lowest, separated_waves(stations, medium)))
    elif by_name:
        remarks.append("fewer than two tensions or strains with lines: waves not separated by places")
    return WaveFindings(fronts, speed, tuple(parts), remarks=tuple(remarks))


def replayed_waves(
    response: Response, start: float, drive: DriveFit | None, window: Window | None, rig: Rig
) -> WaveFindings:
    """Return the waves at every gauge of a replay, and where its tension is largest.

    Parameters
    ----------
    response : Response
        With its velocity field.
    start : float
        Run time of its time zero [s].
    drive : DriveFit or None
        Frequency of the drive.
    window : Window or None
        The steady part, on the run's clock.
    rig : Rig
        For the uncertainties.
    """
    largest = largest_tension(response, start, window)
    if drive is None or window is None or "velocity" not in response.fields:
        return WaveFindings(largest=largest, remarks=("no drive: the replayed waves are not separated",))
    if any(
        first + start < window.stop and last + start > window.start
        for spans in response.slack.values()
        for first, last in spans
    ):
        text = "the replayed cable goes slack in the window: waves do not superpose, none separated"
        return WaveFindings(largest=largest, remarks=(text,))
    medium = medium_of(response.scene, rig)
    parts, remarks = [], []
    for number, at in enumerate(response.gauges):
        tension = _series(Kind.TENSION, "N", response, start, response.tension[:, number], float(at))
        upwards = response.fields["velocity"][:, number, 2]
        velocity = _series(Kind.VELOCITY, "m/s", response, start, upwards, float(at))
        try:
            found = [find_lines(part, window, drive, Expectation()) for part in (tension, velocity)]
        except DataError as error:
            remarks.append(f"replayed waves at {at:g}: {error.problem}")
            continue
        orders = section_waves(Station(float(at), found[0]), Station(float(at), found[1]), medium)
        parts.append(Waves(REPLAYED, f"tension and velocity at {at:g}", float(at), orders))
    return WaveFindings(parts=tuple(parts), largest=largest, remarks=tuple(remarks))


def largest_tension(response: Response, start: float = 0.0, window: Window | None = None) -> LargestTension:
    """Return where along the cable and when the replayed tension is largest.

    The interval holds every place whose largest tension comes within the replay's stated error of it.
    """
    field, budget = response.field, response.error
    time = field.time + start
    inside = np.ones(time.size, dtype=bool)
    if window is not None and np.any((time >= window.start) & (time <= window.stop)):
        inside = (time >= window.start) & (time <= window.stop)
    highest = field.maximum[inside]
    row, column = np.unravel_index(int(np.argmax(highest)), highest.shape)
    value = float(highest[row, column])
    along = highest.max(axis=0)
    relative = math.hypot(budget.numerical, budget.model or 0.0, budget.spread or 0.0)
    dynamic = max(value - float(field.maximum[0, column]), 0.0)
    near = field.position[along >= value - relative * dynamic]
    begins = field.time[inside]
    more = highest - field.maximum[0]
    instant, place = np.unravel_index(int(np.argmax(more)), more.shape)
    return LargestTension(
        at=float(field.position[column]),
        time=_instant(response, float(field.position[column]), float(begins[row])) + start,
        value=value,
        at_interval=(float(near.min()), float(near.max())),
        bottom=float(along[0]),
        top=float(along[-1]),
        over_rest=float(more[instant, place]),
        over_rest_at=float(field.position[place]),
        over_rest_time=_instant(response, float(field.position[place]), float(begins[instant])) + start,
    )


def _instant(response: Response, at: float, begin: float) -> float:
    """Return when the tension at a place is largest within the field's bin that begins at a time [s].

    A gauge there tells it to one row; elsewhere it is the middle of the bin.
    """
    field = response.field
    width = float(field.time[1] - field.time[0]) if field.time.size > 1 else response.scene.output.duration
    rows = np.flatnonzero((response.time >= begin) & (response.time <= begin + width))
    gauge = int(np.argmin(np.abs(response.gauges - at)))
    if rows.size == 0 or abs(float(response.gauges[gauge]) - at) > SAME_PLACE:
        return begin + 0.5 * width
    return float(response.time[rows[int(np.argmax(response.tension[rows, gauge]))]])


def _knock(
    measured: ConditionedRun, medium: Medium, rig: Rig
) -> tuple[tuple[Front, ...], WaveSpeed | None, list[str]]:
    """Return the fronts of the first knock in the rest before the drive, and the speed they imply."""
    rest = measured.rest_before
    if rest is None:
        return (), None, ["no rest before the drive: no knock whose fronts could be timed"]
    window = Window(rest.start + SETTLE, rest.stop)
    clocks = {clock.clock: clock.offset_error for clock in measured.clocks}
    found: list[Front] = []
    for channel in measured.channels:
        if channel.kind not in FORCES or channel.at is None or not channel.usable.any():
            continue
        error = clocks.get(channel.source.clock, 0.0) if channel.source else 0.0
        try:
            front = find_front(channel, window, error)
        except DataError:  # too few samples at rest: this sensor times nothing
            continue
        if front is not None:
            found.append(front)
    if not found:
        return (), None, ["no front in the rest before the drive: knock on the base plate to time waves"]
    first = min(front.interval[1] for front in found)
    traverse = SPAN * medium.length / medium.speed
    fronts = tuple(front for front in found if front.interval[0] <= first + traverse)
    mass_error = rig.uncertainty.get("cable.mass_per_length", 0.0) / rig.cable.mass_per_length
    mass = medium.impedance / medium.speed
    try:
        return fronts, wave_speed(fronts, "axial", medium.length, mass, mass_error=mass_error), []
    except DataError as error:
        return fronts, None, [error.problem]


def _station(channel: Channel, lines: ChannelLines, measured: ConditionedRun, scene: Scene) -> Station:
    factor = rest_state(scene).axial_stiffness if channel.kind == "strain" else 1.0
    clocks = {clock.clock: clock.offset_error for clock in measured.clocks}
    late = clocks.get(channel.source.clock, 0.0) if channel.source else 0.0
    return Station(channel.at or 0.0, lines, factor, channel.uncertainty, late)


def _series(kind: Kind, unit: str, response: Response, start: float, values: object, at: float) -> Channel:
    flags = np.zeros(response.time.size, dtype=np.uint16)
    series = np.asarray(values, dtype=np.float64)
    return Channel(f"{kind}@{at:g}", kind, unit, response.time + start, series, flags, at=at)
