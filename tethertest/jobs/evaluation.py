"""One run, evaluated once: conditioned, driven, replayed and searched, each when it is first asked for.

Every command that says something of a run asks here, so that all of them say the same.
"""

from __future__ import annotations

import contextlib
import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from functools import cached_property
from pathlib import Path
from typing import Final

import numpy as np

from tethertest.compare import compare
from tethertest.conditioning import RigPriors, condition, stated_findings
from tethertest.conditioning.stated import bottom_displacement
from tethertest.errors import DataError
from tethertest.jobs.analysis_options import (
    FALSE_LINES_OF_RUN,
    Options,
    check_drive,
    named_naturals,
    window_asked,
)
from tethertest.jobs.expect import expectation
from tethertest.jobs.stored import run_of
from tethertest.jobs.wave_findings import medium_of
from tethertest.readers import load_run, read_log
from tethertest.records.analysis import MEASURED, REPLAYED, ChannelAnalysis
from tethertest.records.channel import Channel, ConditionedRun, Finding, RawLog, Side, Window
from tethertest.records.comparison import Comparison
from tethertest.records.lines import ChannelLines, DriveFit
from tethertest.records.response import NaturalFrequency, Response
from tethertest.records.run import Run
from tethertest.records.scene import Scene
from tethertest.replay import (
    BottomMotion,
    bottom_motion,
    expected_bottom_tension,
    member_channels,
    motion_reach,
    replayed_channels,
    rest_tensions,
    run_scene,
    variations,
)
from tethertest.replay.mechanics import tension_changes, tension_over_motion
from tethertest.solver import FIRST_MESH, modes, solve
from tethertest.spectra import find_events, find_lines, fit_drive
from tethertest.spectra.crank_angle import CrankAngle, crank_angle
from tethertest.spectra.snaps import with_snaps
from tethertest.spectra.waves import Medium
from tethertest.store import is_store, load_store

#: finest mesh of a replay; a snap on the rig is not better known than this
FINEST_MESH: Final = 40
#: kinds of channels that the cable answers with, and that share a run's chance of a false line
ANSWERS: Final = ("tension", "strain")
#: share of a window's samples that a search for lines needs
MOST_OF_A_WINDOW: Final = 0.5
#: kinds that no drive moves: smoothed by the instrument they would pass for the most exact channels
SLOW_KINDS: Final = frozenset(["temperature", "count", "other"])


class Evaluation:
    """A run and all that is found in it.

    Parameters
    ----------
    run : Run
        The run and its rig.
    options : Options
        What is known or asked beyond the run's own files; without any, every command sees the same.
    stored : ConditionedRun, optional
        The conditioned run as a store holds it; conditioned from the run's logs where absent.
    place : Path, optional
        What errors are about: the run folder if absent.

    Raises
    ------
    DataError
        By any part: the data cannot be used; see `errors_placed`.
    """

    def __init__(
        self,
        run: Run,
        options: Options | None = None,
        stored: ConditionedRun | None = None,
        place: Path | None = None,
    ) -> None:
        self.run = run
        self.options = options or Options()
        self._stored = stored
        self._place = place
        self._found: dict[tuple[str, str], ChannelAnalysis] = {}

    @cached_property
    def logs(self) -> Mapping[str, RawLog]:
        """The raw logs, by `Log.key`."""
        return read_logs(self.run)

    @cached_property
    def conditioned(self) -> ConditionedRun:
        """Channels on one clock, as conditioning leaves them."""
        return condition(self.run, self.logs, rig_priors(self.run)) if self._stored is None else self._stored

    @cached_property
    def stated(self) -> tuple[Finding, ...]:
        """What the run file states and the logs contradict."""
        return stated_findings(self.run, self.conditioned, self.drive)

    @cached_property
    def measured(self) -> ConditionedRun:
        """Channels on one clock, with all findings."""
        return replace(self.conditioned, findings=(*self.conditioned.findings, *self.stated))

    @cached_property
    def heave(self) -> Channel | None:
        """The channel that shows the bottom motion, if it was logged."""
        return bottom_displacement(self.conditioned.channels)

    @cached_property
    def nominal(self) -> float | None:
        """Frequency of the drive as it was set [Hz]; None where there is no drive."""
        if self.options.drive_frequency is not None:
            return self.options.drive_frequency
        return None if self.run.file.drive.kind == "none" else self.run.file.drive.frequency

    @cached_property
    def window(self) -> Window | None:
        """The part that is searched: as asked, else the steady one."""
        if self.options.window is None:
            return self.conditioned.steady
        return window_asked(self.options.window, *self._span)

    @cached_property
    def drive(self) -> DriveFit | None:
        """The drive as its channels show it, the drift of their clocks in its standard error."""
        if self.nominal is None or self.window is None:
            return None
        channels = _drive_channels(self.conditioned.channels, self.heave)
        for channel in channels:
            check_drive(channel, self.window, self.nominal)
        fit = fit_drive(channels, self.window, self.nominal)
        clocks = {clock.clock: clock.drift_error for clock in self.conditioned.clocks}
        drift_error = max(clocks.get(c.source.clock, 0.0) if c.source else 0.0 for c in channels)
        return replace(fit, standard_error=math.hypot(fit.standard_error, drift_error * fit.frequency))

    @cached_property
    def crank(self) -> CrankAngle | None:
        """The crank's angle, where the measured motion tells it clearly.

        Without it a channel whose own order 1 wanders is put on the clock of that.
        """
        if self.heave is None or self.window is None or self.drive is None:
            return None
        crank = crank_angle(self.heave, self.window, self.drive)
        return crank if crank.clear else None

    @cached_property
    def motion(self) -> BottomMotion | None:
        """The measured bottom motion as it drives the replay."""
        if self.heave is None:
            return None
        return bottom_motion(
            self.heave,
            frequency=None if self.drive is None else self.drive.frequency,
            rest_before=self.conditioned.rest_before,
            rest_after=self.conditioned.rest_after,
            steady=self.conditioned.steady,
        )

    @cached_property
    def scene(self) -> Scene:
        """The scene that the run stands for, over the time its motion was measured."""
        first, last = self._span
        scene = run_scene(self.run, last - first if self.motion is None else self.motion.duration)
        return replace(scene, output=replace(scene.output, fields=("velocity",)))

    @cached_property
    def medium(self) -> Medium:
        """The cable as its axial waves see it."""
        return medium_of(self.scene, self.run.rig)

    @cached_property
    def natural_frequencies(self) -> tuple[NaturalFrequency, ...]:
        """Of the scene, then those that were given."""
        return (*modes(self.scene).frequencies, *named_naturals(self.options))

    @cached_property
    def response(self) -> Response | None:
        """The replay, with the velocity at its gauges; None where no bottom motion was logged."""
        if self.motion is None:
            return None
        return solve(self.scene, measured=self.motion.motion, finest=FINEST_MESH)

    @cached_property
    def replayed(self) -> tuple[Channel, ...]:
        """Replayed tensions and strains, at the places and times of the measured ones."""
        if self.motion is None or self.response is None:
            return ()
        return replayed_channels(self.response, self.motion, self.conditioned.channels)

    @cached_property
    def moved(self) -> tuple[tuple[Channel, ...], ...]:
        """Replays on a coarser mesh: the nominal one, then one for each uncertain parameter, moved."""
        if self.motion is None or self.response is None or self.drive is None:
            return ()
        coarser = max(FIRST_MESH, self.response.cells // 2)
        varied = variations(self.run, self.motion, self.conditioned.channels, coarser, self.response.fidelity)
        return tuple(variation.channels for variation in varied)

    @cached_property
    def members(self) -> tuple[tuple[Channel, ...], ...]:
        """Replays of a cable that goes slack, by what nobody knows of it, the nominal one first."""
        if self.motion is None or self.response is None:
            return ()
        return member_channels(self.response, self.motion, self.conditioned.channels)

    @cached_property
    def motion_lines(self) -> ChannelLines | None:
        """Lines of the bottom motion, against which those of the other channels are held."""
        if self.heave is None or self.window is None or self.drive is None:
            return None
        return self._lines(self.heave, None, FALSE_LINES_OF_RUN)

    @cached_property
    def significance(self) -> float:
        """Chance of one false line in a channel, so that all of a run share `FALSE_LINES_OF_RUN`.

        It does not depend on which channels a command shows.
        """
        searched = [c for c in self.conditioned.channels if c.kind in ANSWERS and self._covers(c)]
        return FALSE_LINES_OF_RUN / max(1, len(searched))

    def found(self, channel: Channel, side: Side = MEASURED) -> ChannelAnalysis:
        """Return the lines and events of one channel, or why there are none.

        Parameters
        ----------
        channel : Channel
            One of `conditioned`, or of `replayed`.
        side : str
            `MEASURED` or `REPLAYED`.
        """
        key = channel.name, side
        if key not in self._found:
            self._found[key] = self._searched(ChannelAnalysis(channel, side))
        return self._found[key]

    @cached_property
    def comparison(self) -> Comparison:
        """Measured against replayed, with the verdict."""
        comparison = compare(
            self.measured,
            self.replayed,
            self.lines(self.conditioned.channels),
            self.lines(self.replayed, REPLAYED),
            self.run.rig.limits,
            variations=self.moved,
            members=self.members,
            static=rest_tensions(self.run.rig),
        )
        if self.response is None:
            return comparison
        first, *others = comparison.reasons
        return replace(comparison, reasons=(first, *self.response.warnings, *others))

    def lines(self, channels: Sequence[Channel], side: Side = MEASURED) -> tuple[ChannelLines, ...]:
        """Return the lines of the motion and of the channels that the cable answers with."""
        chosen = [channel for channel in channels if channel is self.heave or channel.kind in ANSWERS]
        ordered = sorted(chosen, key=lambda channel: channel is not self.heave)
        found = (self.found(channel, side).lines for channel in ordered)
        return tuple(lines for lines in found if lines is not None)

    @contextlib.contextmanager
    def errors_placed(self) -> Iterator[None]:
        """Give errors about the data the place of their file; what no log is to blame for is in run.toml."""
        try:
            yield
        except DataError as error:
            if self._place is not None:
                raise error.located(self._place) from error
            name = error.path or "run.toml"
            of_run = error.path is None or name in {log.file for log in self.run.file.log}
            path = self.run.folder / name if of_run else name
            raise DataError(error.problem, error.remedy, path=path, line=error.line) from error

    @property
    def _span(self) -> tuple[float, float]:
        """First and last time of the run's channels [s]."""
        spans = [channel.time[[0, -1]] for channel in self.conditioned.channels]
        return min(float(span[0]) for span in spans), max(float(span[1]) for span in spans)

    def _covers(self, channel: Channel) -> bool:
        if self.window is None:
            return bool(channel.usable.any())
        usable = np.count_nonzero(channel.between(self.window.start, self.window.stop).usable)
        return bool(usable > MOST_OF_A_WINDOW * self.window.length * channel.rate)

    def _searched(self, item: ChannelAnalysis) -> ChannelAnalysis:
        channel = item.channel
        if channel.kind == "tension":
            try:
                item = replace(item, events=with_snaps(channel, find_events(channel), self.medium))
            except DataError as error:
                item = replace(item, no_events=error.problem)
        if self.drive is None:
            return replace(item, no_lines="no drive")
        if not self._covers(channel):
            return replace(item, no_lines="less than half of the window has usable samples")
        try:
            if channel is self.heave:
                return replace(item, lines=self.motion_lines)
            return replace(item, lines=self._lines(channel, self.motion_lines, self.significance))
        except DataError as error:
            return replace(item, no_lines=error.problem)

    def _lines(self, channel: Channel, motion: ChannelLines | None, significance: float) -> ChannelLines:
        if self.window is None or self.drive is None:
            message = f"channel {channel.name!r} has no drive and no window to look for its lines"
            raise ValueError(message)
        told = expectation(self.run, self.scene, channel, self.drive.frequency, motion)
        told = replace(told, natural_frequencies=self.natural_frequencies, mains=self.options.mains)
        return find_lines(channel, self.window, self.drive, told, significance=significance, crank=self.crank)


def open_evaluation(path: Path, options: Options | None = None) -> Evaluation:
    """Open a run folder or a run store; its logs are read when they are first needed.

    Parameters
    ----------
    path : Path
        Folder with run.toml, or a store as ``ingest`` writes it.
    options : Options, optional
        What is asked; `Options.rigs` is where rig files are looked for.

    Raises
    ------
    TethertestError
        The run or rig file, or the store, cannot be read.
    """
    asked = options or Options()
    if not (path.is_file() and is_store(path)):
        return open_run(path, asked)
    stored = load_store(path)
    return Evaluation(run_of(stored.header, path), asked, stored.measured, path)


def open_run(folder: Path, options: Options) -> Evaluation:
    """Open a run folder; see `open_evaluation`."""
    return Evaluation(load_run(folder, options.rigs), options)


def read_logs(run: Run) -> dict[str, RawLog]:
    """Read the logs of a run, by their `Log.key`.

    Raises
    ------
    FileFormatError
        A log cannot be read.
    """
    return {log.key: read_log(run.folder / log.file, log) for log in run.file.log}


def rig_priors(run: Run) -> RigPriors:
    """Return what the solver tells the conditioning of a run."""
    return RigPriors(
        static_tension=rest_tensions(run.rig),
        expected_tension=expected_bottom_tension(run),
        tension_changes=tension_changes(run),
        tension_over_motion=tension_over_motion(run),
        motion_reach=motion_reach(run.file.drive.frequency),
        drive_frequency=run.file.drive.frequency,
    )


def _drive_channels(channels: Sequence[Channel], heave: Channel | None) -> Sequence[Channel]:
    """Return the channels that tell a run's drive: its motion, else its tensions, else what it moves."""
    if heave is not None:
        return [heave]
    mechanical = [channel for channel in channels if channel.kind not in SLOW_KINDS]
    return [channel for channel in channels if channel.kind == "tension"] or mechanical or channels
