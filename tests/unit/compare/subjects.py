"""One channel built by hand, so that every term of its uncertainty can be set alone."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction

import numpy as np

from tethertest.compare.alignment import Pair
from tethertest.compare.subject import Subject
from tethertest.records.arrays import FloatArray
from tethertest.records.channel import Channel, Window
from tethertest.records.lines import ChannelLines, Line, LineVerdict
from tethertest.records.rig import Limits

DRIVE = 0.5
WINDOW = Window(0.0, 20.0)
TIME = np.arange(2001) / 100.0


def channel(values: FloatArray | float, **fields: object) -> Channel:
    filled = np.broadcast_to(np.asarray(values, dtype=np.float64), TIME.shape)
    defaults: dict[str, object] = {"name": "tension_top", "kind": "tension", "unit": "N"}
    flags = np.zeros(TIME.size, dtype=np.uint16)
    return Channel(**{**defaults, **fields}, time=TIME, values=filled, flags=flags)  # type: ignore[arg-type]


def cosine(amplitude: float, phase: float = 0.0, order: float = 1.0) -> FloatArray:
    return amplitude * np.cos(2.0 * np.pi * order * DRIVE * TIME + phase)


def pair(measured: FloatArray | float = 0.0, replayed: FloatArray | float = 0.0, **fields: object) -> Pair:
    sides = (np.broadcast_to(np.asarray(side, dtype=np.float64), TIME.shape) for side in (measured, replayed))
    plain = Pair(TIME, np.ones(TIME.size, dtype=bool), *sides, 10.0, 10.0, 30.0, 0.0, 0.0)
    return replace(plain, **fields)


def line(
    order: str,
    amplitude: float,
    phase: float = 0.0,
    standard_error: float = 0.0,
    verdict: LineVerdict = LineVerdict.HARMONIC,
) -> Line:
    interval = (max(0.0, amplitude - 2.0 * standard_error), amplitude + 2.0 * standard_error)
    frequency = float(Fraction(order)) * DRIVE
    return Line(order, frequency, amplitude, phase, interval, standard_error, 0.0, verdict, "")


def lines(*found: Line) -> ChannelLines:
    return ChannelLines("tension_top", "N", WINDOW, found, TIME.size, 0)


def subject(**fields: object) -> Subject:
    plain = Subject(
        measured=channel(0.0),
        replayed=channel(0.0),
        window=WINDOW,
        drive=DRIVE,
        pair=pair(),
        measured_lines=None,
        replayed_lines=None,
        moved=(),
        moved_pairs=(),
        members=(),
        member_pairs=(),
        clock_error=0.0,
        static=0.0,
        limits=Limits(),
        limited=True,
    )
    return replace(plain, **fields)
