"""Time of the line search on 90 s at 1 kHz: medians, and the ratio to reading the samples once."""

from __future__ import annotations

import time as clock
from collections.abc import Callable

import numpy as np

from tethertest.records.channel import Channel, Window
from tethertest.records.lines import Expectation
from tethertest.spectra import find_lines, fit_drive

TIME = np.arange(90_000) / 1000.0
WINDOW = Window(0.0, 90.0)
REPEATS = 7


def record(frequency: float, *, rich: bool) -> Channel:
    random = np.random.default_rng(1)
    orders = {1.0: 2.0, 2.0: 0.2, 3.0: 0.1}
    if rich:  # broken orders that are followed, and two free lines
        orders |= {0.5: 0.05, 1.5: 0.05, 2.5: 0.05, 0.43: 0.05, 1.22: 0.04}
    values = 0.05 * random.standard_normal(TIME.size)
    for order, amplitude in orders.items():
        values += amplitude * np.cos(2.0 * np.pi * order * frequency * TIME + order)
    return Channel("tension", "tension", "N", TIME, values, np.zeros(TIME.size, dtype=np.uint16))


def median(work: Callable[[], object]) -> float:
    spans = []
    for _ in range(REPEATS):
        start = clock.perf_counter()
        work()
        spans.append(clock.perf_counter() - start)
    return float(np.median(spans))


def main() -> None:
    print("| drive [Hz] | record | drive fit [s] | lines [s] | lines over one pass of sin |")
    print("| --- | --- | --- | --- | --- |")
    once = median(lambda: np.sin(TIME))
    for frequency in (0.3, 2.0, 7.5):
        for name, rich in (("plain", False), ("rich", True)):
            channel = record(frequency, rich=rich)
            drive = fit_drive([channel], WINDOW, 1.01 * frequency)
            fit = median(lambda: fit_drive([channel], WINDOW, 1.01 * frequency))  # noqa: B023
            lines = median(lambda: find_lines(channel, WINDOW, drive, Expectation()))  # noqa: B023
            print(f"| {frequency:g} | {name} | {fit:.3f} | {lines:.3f} | {lines / once:.0f} |")
    channels = [record(0.3, rich=False)] * 100
    start = clock.perf_counter()
    for channel in channels:
        find_lines(channel, WINDOW, drive_of(channel), Expectation())
    print(f"\n100 channels, drive fit and lines each: {clock.perf_counter() - start:.1f} s on one core")


def drive_of(channel: Channel):
    return fit_drive([channel], WINDOW, 0.303)


if __name__ == "__main__":
    main()
