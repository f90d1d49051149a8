"""A made-up but complete report: the 3 m rig held by its position loop, driven at 0.3 Hz."""

from __future__ import annotations

import datetime as dt
from dataclasses import replace
from fractions import Fraction
from pathlib import Path

import numpy as np

from tethertest.records.cable import Cable, Platform, PlatformMode
from tethertest.records.channel import (
    Channel,
    ClockFit,
    ConditionedRun,
    Finding,
    Flag,
    Severity,
    Source,
    Window,
)
from tethertest.records.comparison import Comparison, Metric, Verdict
from tethertest.records.lines import ChannelLines, DriveFit, Event, EventKind, Line, LineVerdict
from tethertest.records.report import Provenance, Report
from tethertest.records.response import ErrorBudget, Field, Response, Status
from tethertest.records.rig import Instrument, Limits, Rig, Sensor
from tethertest.records.run import Drive, Exclude, Log, Run, RunFile, RunPlatform
from tethertest.records.scene import Bottom, Geometry, Output, Scene, Top
from tethertest.records.similarity import PiGroup, Similarity

DRIVE = 0.300012  #: [Hz]
DURATION = 90.0  #: [s]
LENGTH = 3.0  #: [m]
AXIAL_STIFFNESS = 10020.0  #: [N]
GRATINGS = {"fbg1": 0.1, "fbg2": 0.3, "fbg3": 0.5, "fbg4": 0.7, "fbg5": 0.9}
STEADY = Window(15.0, 82.0)


def fake_report(*, frequency: float = DRIVE, verdict: Verdict = Verdict.PASS) -> Report:
    """Return a report with every part there."""
    rng = np.random.default_rng(7)
    measured, replayed = _channels(frequency, rng)
    lines = tuple(
        _lines(channel, 1.0, frequency) for channel in measured if channel.kind in {"tension", "strain"}
    )
    replayed_lines = tuple(_lines(channel, 1.02, frequency) for channel in replayed)
    return Report(
        run=_run(frequency),
        measured=_conditioned(measured),
        response=_response(frequency),
        replayed=replayed,
        drive=DriveFit(frequency, 4.2e-6, ("displacement_bottom", "tension_top")),
        measured_lines=lines,
        replayed_lines=replayed_lines,
        events=_events(frequency, 0.0),
        replayed_events=_events(frequency, 0.006),
        comparison=_comparison(verdict),
        similarity=_similarity(),
        provenance=_provenance(),
    )


def bare_report() -> Report:
    """Return a report of a run in which next to nothing could be done."""
    report = fake_report(verdict=Verdict.UNDECIDED)
    measured = replace(
        report.measured,
        channels=(),
        clocks=(),
        findings=(Finding("daq", "clock_broken", "the log has no usable clock", Severity.FATAL),),
        rest_before=None,
        rest_after=None,
        steady=None,
    )
    return replace(
        report,
        measured=measured,
        response=None,
        replayed=(),
        drive=None,
        measured_lines=(),
        replayed_lines=(),
        events=(),
        replayed_events=(),
        comparison=Comparison((), Verdict.UNDECIDED, ("nothing can be decided: no usable clock",)),
        similarity=None,
    )


def tension(time: np.ndarray, at: float | np.ndarray, frequency: float) -> np.ndarray:
    """Return a tension that looks like the rig's [N]."""
    ramp = np.clip((time - 6.0) / 4.0, 0.0, 1.0) * np.clip((86.0 - time) / 2.0, 0.0, 1.0)
    phase = 2.0 * np.pi * frequency * time
    wave = 4.6 * np.cos(phase) + 0.58 * np.cos(2.0 * phase + 0.4) + 0.09 * np.cos(3.0 * phase)
    return np.maximum(5.0 - 1.42 * (1.0 - at) + ramp * wave * (1.0 + 0.06 * (1.0 - at)), 0.0)


def _channels(frequency: float, rng: np.random.Generator) -> tuple[tuple[Channel, ...], tuple[Channel, ...]]:
    fast, slow = np.arange(0.0, DURATION, 1e-3), np.arange(0.37, DURATION - 0.2, 1e-2)
    measured, replayed = [], []
    for name, at in (("tension_top", 1.0), ("tension_bottom", 0.0)):
        clean = tension(fast, at, frequency)
        values = 0.985 * clean + 0.06 * rng.standard_normal(fast.size)
        flags = np.zeros(fast.size, np.uint16)
        if at == 1.0:
            spikes = rng.choice(fast.size, 12, replace=False)
            values[spikes] += 40.0
            flags[spikes] = Flag.SPIKE
            flags[48000:48400] = Flag.STUCK
            values[48000:48400] = values[48000]
        steps = ("volts to N with 49.68 N per mV/V", "tared over 0.00 to 5.00 s: −0.213 N")
        source = Source(
            "tension.lvm",
            "c0ffee" * 10 + "beef",
            "lvm",
            "mV/V",
            "daq",
            steps,
        )
        measured.append(Channel(name, "tension", "N", fast, values, flags, at, 0.0011, 0.06, source))
        replayed.append(Channel(name, "tension", "N", fast, clean, np.zeros_like(flags), at))
    for name, at in GRATINGS.items():
        rest = 5.0 - 1.42 * (1.0 - at)
        clean = (tension(slow, at, frequency) - rest) / AXIAL_STIFFNESS
        values = clean * 1.01 + 1.3e-6 * rng.standard_normal(slow.size)
        flags = np.zeros(slow.size, np.uint16)
        if name == "fbg4":
            flags[3000:3600] = Flag.LOST
            values[3000:3600] = np.nan
        source = Source("fbg.txt", "0badc0de" * 8, "enlight", "nm", "interrogator", ("strain from nm",))
        measured.append(Channel(name, "strain", "1", slow, values, flags, at, 0.01, 1.3e-6, source))
        replayed.append(Channel(name, "strain", "1", slow, clean, np.zeros_like(flags), at))
    motion = 0.1 * np.sin(2.0 * np.pi * frequency * slow)
    none = np.zeros(slow.size, np.uint16)
    measured.append(Channel("displacement_bottom", "displacement", "m", slow, motion, none, 0.0, 1e-3, 5e-5))
    measured.append(Channel("temp1", "temperature", "K", slow, 296.4 + 0.01 * slow, none, 0.5, 0.0, 0.02))
    return tuple(measured), tuple(replayed)


def _conditioned(channels: tuple[Channel, ...]) -> ConditionedRun:
    clocks = (
        ClockFit(
            "interrogator",
            "daq",
            1.3702,
            0.00041,
            41.3e-6,
            3.1e-6,
            "cross-correlation of the top tension with fbg5",
            ("day and month were swapped: read as 2026-09-05",),
        ),
        ClockFit("encoder", "daq", -0.4127, 0.0009, -22.7e-6, 6.4e-6, "fundamental of the drive", ()),
    )
    note, warning = Severity.NOTE, Severity.WARNING
    lost = "the grating's peak was not seen; later columns slipped by one"
    swapped = "the stamps say 9 May; run.toml says 5 September"
    findings = (
        Finding("tension_top", "spike", "12 single samples far from their neighbours", note, (), 12),
        Finding("tension_top", "stuck", "the value repeats for 0.40 s", warning, ((48.0, 48.4),), 400),
        Finding("fbg4", "lost", lost, warning, ((30.37, 36.36),), 600),
        Finding("interrogator", "day_month_swapped", swapped, warning),
    )
    return ConditionedRun(
        channels, clocks, findings, Window(0.0, 5.0), Window(87.0, 89.9), replace(STEADY, reason="found")
    )


def _response(frequency: float) -> Response:
    time = np.arange(0.0, DURATION, 2e-3)
    gauges = np.array([0.0, *GRATINGS.values(), 1.0])
    total = tension(time[:, None], gauges[None, :], frequency)
    rest = total[0]
    position = np.linspace(0.0, 1.0, 61)
    bins = np.arange(0.0, DURATION, 0.04)
    fine = tension(bins[:, None] + 0.02, position[None, :], frequency)
    scene = Scene(
        "rig3m-run07",
        Cable(LENGTH, "unstretched", 0.0484, AXIAL_STIFFNESS),
        Geometry("vertical", 5.0),
        Bottom("measured"),
        Top("platform", 0.4, 5.0, hover_stiffness=50.0),
        Output(DURATION, 500.0, tuple(gauges)),
    )
    return Response(
        scene=scene,
        status=Status.OK,
        fidelity="nonlinear",
        scheme="characteristics, second order",
        cells=60,
        time_step=1.1e-4,
        wall=1.83,
        time=time,
        gauges=gauges,
        tension=total,
        strain=(total - rest) / AXIAL_STIFFNESS,
        platform_position=0.01 * np.sin(2.0 * np.pi * frequency * time),
        field=Field(bins, position, fine + 0.05, fine - 0.05),
        error=ErrorBudget(0.0031, 0.0012, 0.02),
        slack={0.0: ((20.1, 20.3),)},
        warnings=("internal damping is unknown; the range over 0 to 1 ms is the spread",),
    )


def _lines(channel: Channel, factor: float, frequency: float) -> ChannelLines:
    size = 1.0 if channel.kind == "tension" else 1.0 / AXIAL_STIFFNESS
    error = 0.0009 * size
    table = (
        ("1/3", 0.0007, 0.62, LineVerdict.NONE, "not significant after Holm over 12 orders"),
        ("1/2", 0.0011, 0.31, LineVerdict.NOT_RESOLVABLE, "natural frequency 0.1265 Hz needs 1333 s"),
        ("2/3", 0.0005, 0.8, LineVerdict.NONE, "not significant after Holm over 12 orders"),
        ("1", 4.6, 1e-300, LineVerdict.HARMONIC, "the drive's own order"),
        ("3/2", 0.0008, 0.5, LineVerdict.NONE, "not significant after Holm over 12 orders"),
        ("2", 0.58, 1e-88, LineVerdict.CRANK_HARMONIC, "explained by the crank to 4 %"),
        ("3", 0.09, 2.1e-21, LineVerdict.HARMONIC, "significant and locked to the drive"),
        ("4", 0.004, 0.012, LineVerdict.UNDETERMINED, "significant alone, not after Holm"),
        ("5", 0.002, 0.2, LineVerdict.NONE, "not significant after Holm over 12 orders"),
        ("6", 0.001, 0.4, LineVerdict.NONE, "not significant after Holm over 12 orders"),
        ("7", 0.001, 0.4, LineVerdict.NONE, "not significant after Holm over 12 orders"),
        ("8", 0.0, float("nan"), LineVerdict.NONE, "not significant after Holm over 12 orders"),
    )
    lines = tuple(
        Line(
            order,
            float(Fraction(order)) * frequency,
            factor * amplitude * size,
            0.3 * index,
            (max(factor * amplitude * size - 1.96 * error, 0.0), factor * amplitude * size + 1.96 * error),
            error,
            p_value,
            verdict,
            reason,
        )
        for index, (order, amplitude, p_value, verdict, reason) in enumerate(table)
    )
    return ChannelLines(channel.name, channel.unit, STEADY, lines, 67000, 412)


def _events(frequency: float, shift: float) -> tuple[Event, ...]:
    found = []
    for cycle in range(round(10.0 * frequency), round(83.0 * frequency)):
        middle, half = (cycle + 0.5) / frequency + shift, 0.1 / frequency
        found.append(Event(EventKind.SLACK, "tension_bottom", middle - half, middle + half, 0.0))
        found.append(Event(EventKind.SNAP, "tension_bottom", middle + half, middle + half + 0.05, 9.3))
    return tuple(found)


def _comparison(verdict: Verdict) -> Comparison:
    top = "tension_top"
    metrics = (
        Metric(
            "peak_tension", top, "N", 10.08, 10.22, 0.0139, 0.0061, 0.10, Verdict.PASS, "1.4 % of 10 % used"
        ),
        Metric(
            "order_amplitude 1", top, "N", 4.53, 4.6, 0.0155, 0.0048, 0.05, Verdict.PASS, "within the limit"
        ),
        Metric(
            "order_amplitude 2",
            top,
            "N",
            0.571,
            0.58,
            0.157,
            0.012,
            0.15,
            Verdict.FAIL,
            "0.7 % above the limit",
        ),
        Metric(
            "order_phase 1", top, "rad", 0.901, 0.912, 0.011, 0.004, 0.05, Verdict.PASS, "within the limit"
        ),
        Metric("sprague_geers", top, "1", None, None, 0.0212, 0.007, 0.15, Verdict.PASS, "within the limit"),
        Metric(
            "slack_fraction",
            "tension_bottom",
            "1",
            0.066,
            0.066,
            0.0,
            float("nan"),
            None,
            Verdict.INFORMATIVE,
            "no limit in the rig file",
        ),
        Metric(
            "order_amplitude 1",
            "fbg3",
            "1",
            4.64e-4,
            4.6e-4,
            -0.0086,
            0.01,
            None,
            Verdict.INFORMATIVE,
            "no limit in the rig file",
        ),
    )
    reasons = {
        Verdict.PASS: ("all 5 metrics that have a limit are within it, the closest is sprague_geers",),
        Verdict.FAIL: (
            "tension_top: order_amplitude 2 is off by 15.7 % ± 1.2 %, the limit is 15 %: 0.7 % too much",
            "tension_bottom: the replay is slack for 0.22 s a cycle, the test for 0.18 s",
        ),
        Verdict.UNDECIDED: (
            "tension_top was stuck for 0.4 s of the steady window",
            "order_amplitude 2: the error of 15.7 % ± 4 % straddles the limit of 15 %",
            "interrogator: the clock jumped by 0.8 s at 41.2 s",
            "fbg4 lost its grating from 30.4 s on",
        ),
    }
    return Comparison(metrics, verdict, reasons[verdict])


def _similarity() -> Similarity:
    half = Fraction(1, 2)
    groups = (
        PiGroup(
            "amplitude",
            {"A_e": Fraction(1), "L": Fraction(-1)},
            0.0333,
            0.02,
            1.667,
            "mild",
            "motion of the bottom end over length",
        ),
        PiGroup(
            "axial wave",
            {"omega": Fraction(1), "L": Fraction(1), "rho_l": half, "EA": -half},
            0.01243,
            0.0131,
            0.949,
            "mild",
            "drive against axial waves",
        ),
        PiGroup(
            "static strain",
            {"T": Fraction(1), "EA": Fraction(-1)},
            4.99e-4,
            4.99e-4,
            1.0,
            "matched",
            "pretension over axial stiffness",
        ),
        PiGroup(
            "sag",
            {"rho_l": Fraction(1), "g": Fraction(1), "L": Fraction(1), "T": Fraction(-1)},
            0.2848,
            14.2,
            0.02,
            "violated",
            "weight over pretension",
        ),
        PiGroup("drag", {"rho_a": Fraction(1)}, None, None, None, "irrelevant", "air"),
    )
    ratios = {"length": 50.0, "time": 7.0710678, "force": 2500.0, "strain": 1.0}
    return Similarity(
        groups,
        ratios,
        (("same E", "same rho", "same g"),),
        3,
        ("the prototype is not driven at one frequency",),
    )


def _provenance() -> Provenance:
    return Provenance(
        {"tethertest": "0.1.0", "numpy": "2.4.6", "python": "3.11.7"},
        (("run.toml", "ab" * 32), ("rig3m.toml", "cd" * 32), ("tension.lvm", "ef" * 32)),
        {"tolerance": "1 %", "fidelity": "auto"},
    )


def _run(frequency: float) -> Run:
    gratings = tuple(Sensor(name, "wavelength", at) for name, at in GRATINGS.items())
    rig = Rig(
        name="3 m rig",
        cable=Cable(LENGTH, "unstretched", 0.0484, AXIAL_STIFFNESS),
        platform=Platform(0.4, 5.0, {"free": PlatformMode(), "hold": PlatformMode(50.0, 5.0)}),
        sensor=(
            Sensor("tension_bottom", "tension", 0.0),
            Sensor("tension_top", "tension", 1.0),
            *gratings,
            Sensor("temp1", "temperature", 0.5),
            Sensor("displacement_bottom", "displacement", 0.0),
        ),
        instrument=(Instrument("daq", 1000.0), Instrument("interrogator", 100.0)),
        limits=Limits(),
    )
    file = RunFile(
        id="rig3m-run07",
        rig="rig3m",
        date=dt.datetime(2026, 9, 5, 14, 20, tzinfo=dt.timezone(dt.timedelta(hours=8))),
        drive=Drive("crank-slider", round(frequency, 2), radius=0.1),
        log=(Log("tension.lvm", "daq"), Log("fbg.txt", "interrogator")),
        platform=RunPlatform("hold"),
        title="0.3 Hz, 0.1 m, UAV held",
        operator="A. Technician",
        exclude=(Exclude("tension_top", (41.2, 41.9), "rig was touched"),),
    )
    return Run(Path("rig3m") / "run07", file, rig, Path("rigs") / "rig3m.toml")
