"""The calibration as Markdown, each figure beside what is demanded of it."""

from __future__ import annotations

from collections.abc import Sequence

from reports.line_calibration.power import (
    BIAS,
    PRICE,
    SURE,
    SURE_POWER,
    UNDETERMINED,
    Coverage,
    Found,
)
from reports.line_calibration.rates import Rates, most_at

_HEAD = """# Calibration of the line search

Written by `python -m reports.line_calibration N`: records of 68 s at
30 Hz with a drive near 0.25 Hz, through the drive fit, the crank's angle and the search for ten orders at a
chance of 1 %.
"""


def coverage_met(item: Coverage) -> bool:
    """Return whether the share is as near to 0.95 as allowed, but for chance."""
    error = 3.3 * (0.95 * 0.05 / item.intervals) ** 0.5
    return bool(abs(item.share - 0.95) <= item.allowed + error)


def found_met(item: Found) -> bool:
    """Return whether power, bias and reserve at one amplitude are as demanded, but for chance."""
    error = 3.3 / item.amplitude / item.records**0.5
    close = item.power >= item.theory - PRICE
    sure = item.amplitude < SURE or (item.power >= SURE_POWER and abs(item.bias) <= BIAS + error)
    return close and sure and item.undetermined <= most_at(UNDETERMINED, item.records)


def calibration_table(nulls: Sequence[Rates], found: Sequence[Found], covered: Sequence[Coverage]) -> str:
    """Return the three tables."""
    return "\n".join((_HEAD, *_null_rows(nulls), "", *_power_rows(found), "", *_coverage_rows(covered), ""))


def _word(met: bool) -> str:
    return "met" if met else "missed"


def _null_rows(nulls: Sequence[Rates]) -> list[str]:
    rows = [
        "## Records without a subharmonic",
        "",
        "False: any order p/q called a subharmonic; the limit is what a true rate of 1 % stays below "
        "999 times in 1000. Kinds marked * the record alone cannot tell from a subharmonic: no limit.",
        "",
        "| kind | records | false | limit | no word on any p/q | verdicts at 1/2 | demands |",
        "| --- | --- | --- | --- | --- | --- | --- |",
    ]
    for item in nulls:
        ordered = sorted(item.halves.items(), key=lambda pair: -pair[1])
        halves = ", ".join(f"{verdict.value} {count}" for verdict, count in ordered)
        mark = "*" if item.kind.beyond else ""
        limit = "-" if item.kind.beyond else str(item.limit)
        quiet = f"{item.quiet / item.records:.1%}"
        rows.append(
            f"| {item.kind.name}{mark} | {item.records} | {item.false} | {limit} | {quiet} | {halves} | "
            f"{_word(item.met)} |"
        )
    return rows


def _power_rows(found: Sequence[Found]) -> list[str]:
    rows = [
        "## Locked half orders in white noise",
        "",
        "![Share of locked half orders found against their amplitude](power.png)",
        "",
        "The same numbers are in `power.csv`, with 95 % binomial intervals. Bias is judged from "
        f"{SURE:g} standard errors on: weaker lines are often zero after de-biasing.",
        "",
        "| amplitude [standard errors] | found | F test alone | undetermined | bias | raw bias | demands |",
        "| --- | --- | --- | --- | --- | --- | --- |",
    ]
    rows += [
        f"| {item.amplitude:g} | {item.power:.1%} | {item.theory:.1%} | "
        f"{item.undetermined / item.records:.1%} | {item.bias:+.2%} | {item.raw_bias:+.2%} | "
        f"{_word(found_met(item))} |"
        for item in found
    ]
    return rows


def _coverage_rows(covered: Sequence[Coverage]) -> list[str]:
    rows = [
        "## 95 % intervals",
        "",
        "| noise | intervals | cover | demands |",
        "| --- | --- | --- | --- |",
    ]
    rows += [
        f"| {item.noise} | {item.intervals} | {item.share:.1%} | {_word(coverage_met(item))} |"
        for item in covered
    ]
    return rows
