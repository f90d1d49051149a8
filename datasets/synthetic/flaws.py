"""Flaws put into the samples before they are written, each with its entry for `truth.json`."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from .campaign import Plan
from .instruments import RATED, Record
from .noise import generator

Entry = dict[str, object]
Records = dict[str, Record]
Mask = NDArray[np.bool_]

CLIP_LEVEL = 0.24
FREEZE = 15.0
JUMP = 2.0
HUM = 0.3
SPIKES = 9


def inject(plan: Plan, records: Records) -> list[Entry]:
    """Put the plan's flaws into its records and return their entries."""
    entries: list[Entry] = []
    for flaw in plan.flaws:
        entries += FLAWS[flaw](plan, records)
    return entries


def spans_of(record: Record, mask: Mask) -> dict[str, object]:
    """Return the stretches of a mask in true time and in the log's time."""
    edges = np.flatnonzero(np.diff(np.concatenate(([0], mask.astype(np.int8), [0]))))
    first, last = edges[0::2], edges[1::2] - 1
    return {
        "spans_true_s": np.column_stack((record.true_time[first], record.true_time[last])),
        "spans_log_s": np.column_stack((record.reading[first], record.reading[last])),
        "samples": int(mask.sum()),
        "count": int(first.size),
    }


def _saturated(plan: Plan, records: Records) -> list[Entry]:
    record = records["daq"]
    values = record.channels["tension_top"]
    mask = values >= CLIP_LEVEL
    record.channels["tension_top"] = np.minimum(values, CLIP_LEVEL)
    facts = {"kind": "saturated", "clock": "daq", "channel": "tension_top"}
    return [{**facts, "level_mV_per_V": CLIP_LEVEL, **spans_of(record, mask)}]


def _lost_grating(plan: Plan, records: Records) -> list[Entry]:
    record = records["interrogator"]
    entries: list[Entry] = []
    stretches = {"fbg3": ((17.2, 20.4), (29.5, 31.1), (41.0, 44.3)), "fbg2": ((36.2, 37.6),)}
    for name, spans in stretches.items():
        mask = np.zeros(record.reading.size, dtype=bool)
        for begin, end in spans:
            mask |= (record.true_time >= begin) & (record.true_time < end)
        record.channels[name] = np.where(mask, np.nan, record.channels[name])
        facts = {"kind": "lost-grating", "clock": "interrogator", "channel": name}
        entries.append({**facts, **spans_of(record, mask)})
    return entries


def _stuck(plan: Plan, records: Records) -> list[Entry]:
    record = records["daq"]
    begin = plan.drive.start + plan.drive.ramp_up + 9.3
    mask = (record.true_time >= begin) & (record.true_time < begin + FREEZE)
    values = record.channels["tension_bottom"].copy()
    values[mask] = values[np.flatnonzero(mask)[0]]
    record.channels["tension_bottom"] = values
    facts = {"kind": "stuck", "clock": "daq", "channel": "tension_bottom"}
    return [{**facts, **spans_of(record, mask)}]


def _clock_jump(plan: Plan, records: Records) -> list[Entry]:
    record = records["interrogator"]
    sample = int(np.searchsorted(record.true_time, plan.drive.start + plan.drive.ramp_up + 14.6))
    reading = record.reading.copy()
    reading[sample:] += JUMP
    records["interrogator"] = replace(record, reading=reading)
    return [
        {
            "kind": "clock-jump",
            "clock": "interrogator",
            "channel": None,
            "size_s": JUMP,
            "sample": sample,
            "true_s": float(record.true_time[sample]),
            "log_before_s": float(reading[sample - 1]),
            "log_after_s": float(reading[sample]),
        }
    ]


def _spikes(plan: Plan, records: Records) -> list[Entry]:
    record = records["daq"]
    entries: list[Entry] = []
    for name in ("tension_top", "tension_bottom"):
        random = generator(plan.number, "spikes " + name)
        places = np.sort(random.choice(np.arange(500, record.reading.size - 500), SPIKES, False))
        sizes = random.uniform(5.0, 25.0, SPIKES) * random.choice((-1.0, 1.0), SPIKES)
        values = record.channels[name].copy()
        values[places] += sizes * _per_newton(name)
        record.channels[name] = values
        entries.append(
            {
                "kind": "spikes",
                "clock": "daq",
                "channel": name,
                "count": SPIKES,
                "samples": places,
                "true_s": record.true_time[places],
                "log_s": record.reading[places],
                "size_N": sizes,
            }
        )
    return entries


def _hum(plan: Plan, records: Records) -> list[Entry]:
    record = records["daq"]
    entries: list[Entry] = []
    for name, part in (("tension_top", 1.0), ("tension_bottom", 0.8)):
        phase = float(generator(plan.number, "hum " + name).uniform(0.0, 2.0 * np.pi))
        wave = HUM * part * np.sin(2.0 * np.pi * 50.0 * record.true_time + phase)
        record.channels[name] = record.channels[name] + wave * _per_newton(name)
        entries.append(
            {
                "kind": "hum",
                "clock": "daq",
                "channel": name,
                "frequency_Hz": 50.0,
                "amplitude_N": HUM * part,
            }
        )
    return entries


def _dropped(plan: Plan, records: Records) -> list[Entry]:
    entries: list[Entry] = []
    for clock, gaps, longest in (("encoder", 7, 60), ("interrogator", 4, 25)):
        record = records[clock]
        random = generator(plan.number, "dropped " + clock)
        mask = np.zeros(record.reading.size, dtype=bool)
        for place in random.choice(np.arange(1500, record.reading.size - 1500), gaps, False):
            mask[place : place + int(random.integers(3, longest))] = True
        facts = {"kind": "dropped", "clock": clock, "channel": None}
        entries.append({**facts, **spans_of(record, mask)})
        kept = {name: values[~mask] for name, values in record.channels.items()}
        records[clock] = replace(
            record,
            reading=record.reading[~mask],
            true_time=record.true_time[~mask],
            channels=kept,
        )
    return entries


def _swapped_date(plan: Plan, records: Records) -> list[Entry]:
    return [
        {
            "kind": "swapped-date",
            "clock": "encoder",
            "channel": None,
            "date": plan.date.strftime("%Y-%m-%d"),
            "written": plan.date.strftime("%Y-%d-%m"),
        }
    ]


def _per_newton(name: str) -> float:
    """Return mV/V per newton, near enough for a disturbance."""
    return {"tension_top": 2.013, "tension_bottom": 1.987}[name] / RATED


FLAWS: dict[str, Callable[[Plan, Records], list[Entry]]] = {
    "saturated": _saturated,
    "lost-grating": _lost_grating,
    "stuck": _stuck,
    "clock-jump": _clock_jump,
    "spikes": _spikes,
    "hum": _hum,
    "dropped": _dropped,
    "swapped-date": _swapped_date,
}
