"""What a reader may do with a damaged log: refuse it, or read it as it stands."""

from __future__ import annotations

import csv
import re
import time
from collections import Counter
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from reports.fuzzing import mutate
from reports.fuzzing.seeds import Seed
from tethertest.errors import TethertestError
from tethertest.readers import read_log
from tethertest.records.channel import RawLog


@dataclass
class Tally:
    """What became of the mutants of one reader."""

    mutants: int = 0
    refused: int = 0
    read: int = 0
    failures: list[str] = field(default_factory=list)
    slowest: float = 0.0  #: [s]


def run(seeds: tuple[Seed, ...], numbers: range, path: Path) -> Tally:
    """Read the mutants of these numbers; the seeds take turns."""
    tally = Tally()
    for number in numbers:
        seed = seeds[number % len(seeds)]
        data, change = mutate.mutant(seed.data, number, text=seed.is_text)
        path.write_bytes(data)
        began = time.perf_counter()
        log, wrong = None, []
        try:
            log = read_log(path, seed.settings)
        except TethertestError:
            tally.refused += 1
        except Exception as error:
            wrong = [f"{type(error).__name__}: {error}"]
        tally.slowest = max(tally.slowest, time.perf_counter() - began)
        tally.mutants += 1
        if log is not None:
            tally.read += 1
            wrong = faults(log, data, seed)
        if wrong:
            tally.failures.append(
                f"{seed.reader} ({seed.kind}) mutant {number}, {change}: {'; '.join(wrong)}"
            )
    return tally


def faults(log: RawLog, data: bytes, seed: Seed) -> list[str]:
    """Return what is wrong with a log that was read from a damaged file."""
    found = []
    if not seed.is_text:
        limit = 2 * len(seed.values) if seed.reader == "archive" else len(data)
        lines: list[str] = []
    else:
        text = data.decode(log.encoding or "utf-8", errors="replace").removeprefix("\ufeff")
        lines = text.replace("\r\n", "\n").split("\n")
        limit = len(lines)
    for channel in log.channels:
        if channel.time.shape != channel.values.shape or channel.values.ndim != 1:
            found.append(f"{channel.name!r} has {channel.values.shape} values at {channel.time.shape} times")
        if channel.values.size > limit:
            found.append(f"{channel.name!r} has {channel.values.size} values, the file has {limit} rows")
        if not np.all(np.isfinite(channel.time)):
            found.append(f"{channel.name!r} has times that are no numbers")
    if lines:
        found += _moved(log, lines, seed)
        if log.format == seed.reader:
            found += _against_header(log, lines)
    return found


def _moved(log: RawLog, lines: list[str], seed: Seed) -> list[str]:
    """Return the values of untouched rows that are not under their own names."""
    row_of = {line: row for row, line in enumerate(seed.row_lines)}
    if seed.names_line and lines.count(seed.names_line) != 1:
        return []
    begin = lines.index(seed.names_line) + 1 if seed.names_line else 0
    rows = lines[begin + seed.lines_between :]
    stripped = (line.strip(",\r ") if seed.reader == "json" else line.removesuffix("\r") for line in rows)
    kept = Counter(row_of[line] for line in stripped if line in row_of)
    found = []
    channels = {channel.name: channel for channel in log.channels}
    for column, name in enumerate(seed.names):
        wanted = Counter({round(float(seed.values[row, column]), 6): count for row, count in kept.items()})
        if name not in channels:
            found.append(f"{name!r} is not among {list(channels)}")
            continue
        values = Counter(np.round(channels[name].values[np.isfinite(channels[name].values)], 6).tolist())
        lost = wanted - values
        if lost:
            found.append(
                f"{name!r} lacks {len(lost)} values of rows that were left alone, such as {min(lost)}"
            )
    return found


def _against_header(log: RawLog, lines: list[str]) -> list[str]:
    """Return where a log contradicts what its own header states."""
    return {"lvm": _lvm, "catman": _catman, "toa5": _toa5, "fbgs": _fbgs, "enlight-peaks": _peaks}.get(
        log.format, lambda _log, _lines: []
    )(log, lines)


def _stated(lines: list[str], key: str, number: str = r"[-+\d.,eE]+") -> list[list[float]]:
    """Return the numbers behind each line that begins with a key, where all of them are plain."""
    found = []
    for line in lines:
        head, *cells = line.split("\t")
        filled = [cell.strip() for cell in cells if cell.strip()]
        if head.strip() == key and filled and all(re.fullmatch(number, cell) for cell in filled):
            try:
                found.append([float(cell.replace(",", ".")) for cell in filled])
            except ValueError:
                return []
    return found


def _lvm(log: RawLog, lines: list[str]) -> list[str]:
    found = []
    channels, samples, steps = (_stated(lines, key) for key in ("Channels", "Samples", "Delta_X"))
    if len(channels) == 1 and channels[0] != [len(log.channels)]:
        found.append(f"the header states {channels[0]} channels, {len(log.channels)} were read")
    if len(channels) == len(samples) == 1 and len(samples[0]) == len(log.channels):
        sizes = [channel.values.size for channel in log.channels]
        if sizes != samples[0]:
            found.append(f"the header states {samples[0]} samples, {sizes} were read")
    if len(channels) == len(steps) == 1 and len(steps[0]) == len(log.channels):
        for channel, step in zip(log.channels, steps[0], strict=True):
            if channel.time.size > 1 and abs(float(np.median(np.diff(channel.time))) - step) > 1e-6:
                found.append(
                    f"Delta_X is {step}, {channel.name!r} steps by {np.median(np.diff(channel.time))}"
                )
    return found


def _catman(log: RawLog, lines: list[str]) -> list[str]:
    found = []
    keys = {key: value.strip() for key, _, value in (line.partition(":") for line in lines[:12])}
    rows, count = keys.get("MAXLINES", ""), keys.get("CHANNELS", "")
    size = max(channel.values.size for channel in log.channels)
    if rows.isdecimal() and int(rows) != size:
        found.append(f"MAXLINES is {rows}, {size} rows were read")
    if count.isdecimal() and not len(log.channels) <= int(count) <= len(log.channels) + 1:
        found.append(f"CHANNELS is {count}, {len(log.channels)} were read")
    steps = next((line.split("\t") for line in lines if line.startswith("dt =")), [])
    texts = {match[1] for cell in steps if (match := re.fullmatch(r"dt =([\d.]+) ms", cell.strip()))}
    if len(texts) == 1 and len(steps) == int(count or 0) and size > 1:
        step = float(np.median(np.diff(log.channels[0].time)))
        if abs(step * 1e3 - float(texts.pop())) > 1e-3:
            found.append(f"dt differs from the step {step}")
    return found


def _toa5(log: RawLog, lines: list[str]) -> list[str]:
    names = {cell.strip() for cell in next(csv.reader([lines[1]]))}
    return [
        f"{channel.name!r} is not in the row of names"
        for channel in log.channels
        if re.sub(r" \(\d+\)$", "", channel.name) not in names and channel.name.isascii()
    ]


def _fbgs(log: RawLog, lines: list[str]) -> list[str]:
    header = [cell.strip() for cell in lines[0].split("\t")]
    rows = [line.split("\t") for line in lines[1:] if line.strip()]
    place = header.index("Linenumber") if header.count("Linenumber") == 1 else None
    if place is None or log.rate is None:
        return []
    try:
        numbers = np.array([float(row[place]) for row in rows])
    except (ValueError, IndexError):
        return []
    if numbers.size != log.channels[0].time.size:
        return [f"the file has {numbers.size} rows, {log.channels[0].time.size} were read"]
    expected = (numbers - numbers[0]) / log.rate
    early = float(np.max(expected - log.channels[0].time))
    return [f"a line is {early} s before its number"] if early > 0.5 / log.rate else []


def _peaks(log: RawLog, lines: list[str]) -> list[str]:
    begin = next(place for place, line in enumerate(lines) if line.startswith("Timestamp\t")) + 1
    fibres = lines[begin - 1].rstrip("\t").count("\t")
    filled = [line.split("\t") for line in lines[begin:] if line.strip()]
    try:
        announced = sum(int(cell) for row in filled for cell in row[1 : 1 + fibres])
    except ValueError:
        return []
    read = sum(int(np.count_nonzero(np.isfinite(channel.values))) for channel in log.channels)
    return [] if announced == read else [f"the counts announce {announced} wavelengths, {read} were read"]


def benign(seed: Seed, path: Path) -> list[str]:
    """Return what changes of a sound text log that mean nothing did to what was read."""
    path.write_bytes(seed.data)
    plain = read_log(path, seed.settings)
    found = []
    for label, change in mutate.BENIGN.items():
        path.write_bytes(change(seed.data))
        try:
            other = read_log(path, seed.settings)
        except TethertestError as error:
            found.append(f"{label}: {error}")
            continue
        same = len(plain.channels) == len(other.channels) and all(
            (one.name, one.unit) == (two.name, two.unit)
            and np.array_equal(one.values, two.values, equal_nan=True)
            and np.array_equal(one.time, two.time)
            for one, two in zip(plain.channels, other.channels, strict=True)
        )
        if not same or (plain.start, plain.rate, plain.format) != (other.start, other.rate, other.format):
            found.append(f"{label}: reads as another log")
    return found
