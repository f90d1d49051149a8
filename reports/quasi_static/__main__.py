"""``python -m reports.quasi_static [SCENES] [FIRST] [-o DIR]``: predicted over true error."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

import numpy as np

from reports.quasi_static.measure import Measured, measure
from tethertest.bench.tables import markdown_table
from tethertest.records.arrays import BoolArray, FloatArray
from tethertest.render.write import write_files
from tethertest.solver.quasi_static.validity import LARGEST_SWING, MARGIN

_PREDICTIONS = (
    "prediction", "scenes", "number", "median", "10 %", "90 %", "within 3", "below true",
    "x margin below true",
)  # fmt: skip
_RULES = ("tolerance", "scenes within", "allowed", "wrongly", "3 w < 0.3 w_t and taut", "wrongly")


def main(arguments: list[str]) -> None:
    """Measure as many random scenes as asked for, print the page, and write it where asked."""
    parser = argparse.ArgumentParser(prog="python -m reports.quasi_static", description=__doc__)
    parser.add_argument("scenes", nargs="?", type=int, default=450, help="that are tried [450]")
    parser.add_argument("first", nargs="?", type=int, default=0, help="first seed [0]")
    parser.add_argument("-o", "--output", type=Path, help="folder for the page")
    asked = parser.parse_args(arguments)
    tried = range(asked.first, asked.first + asked.scenes)
    found = [result for result in map(measure, tried) if result is not None]
    page = (
        "# Predicted over true error of the quasi-static model\n\n"
        f"Written by `python -m reports.quasi_static {asked.scenes} {asked.first}`; what the columns mean "
        "stands in [docs/quasi-static.md](../../docs/quasi-static.md).\n\n"
        f"{table(found)}\n"
    )
    sys.stdout.write(page)
    if asked.output is not None:
        write_files(asked.output, {"README.md": page.encode()})


def table(results: list[Measured]) -> str:
    """Return predicted over true error, and what the rule would have allowed, in Markdown.

    Taut scenes whose reference is not good enough are left out.
    """
    good = [result for result in results if result.slack or result.numerical < 0.3 * result.true]
    true = np.array([result.true for result in good])
    taut = np.array([not result.slack for result in good])
    calm = np.array([result.estimate.swing <= LARGEST_SWING for result in good])
    error = np.array([result.estimate.error for result in good])
    kinds = {
        "estimate": error,
        "about rest only": np.array([result.estimate.about_rest for result in good]),
        "A w^2/2g form": np.array([result.simple for result in good]),
    }
    choices = {
        "taut": taut,
        "taut, true < 0.1": taut & (true < 0.1),
        f"taut, swing <= {LARGEST_SWING:g}": taut & calm,
        f"slack, swing <= {LARGEST_SWING:g}": ~taut & calm,
    }
    ratios = [
        _row(name, choice, predicted[rows] / true[rows])
        for name, predicted in kinds.items()
        for choice, rows in choices.items()
    ]
    old = taut & np.array([result.estimate.frequency_ratio < 0.3 for result in good])
    rule = []
    for tolerance in (0.01, 0.03, 0.1, 0.3):
        allowed = calm & (MARGIN * error <= tolerance)
        counts = (true <= tolerance, allowed, allowed & (true > tolerance), old, old & (true > tolerance))
        rule.append((f"{tolerance:g}", *(str(np.count_nonzero(rows)) for rows in counts)))
    return f"{markdown_table(_PREDICTIONS, ratios)}\n\n{markdown_table(_RULES, rule)}"


def _row(name: str, choice: str, quotient: FloatArray) -> tuple[str, ...]:
    if quotient.size == 0:
        return (name, choice, "0", *[""] * 6)
    low, middle, high = np.quantile(quotient, [0.1, 0.5, 0.9])

    def share(rows: BoolArray) -> str:
        return f"{np.mean(rows):.1%}"

    near = (quotient > 1.0 / 3.0) & (quotient < 3.0)
    quantiles = (f"{value:.2f}" for value in (middle, low, high))
    shares = (near, quotient < 1.0, MARGIN * quotient < 1.0)
    return (name, choice, str(quotient.size), *quantiles, *map(share, shares))


if __name__ == "__main__":
    main(sys.argv[1:])
