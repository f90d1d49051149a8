"""What the sweep found as Markdown."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Final

from reports.wave_energy.answer import answers
from reports.wave_energy.cases import CASES, FIGURE_8, RAMP
from reports.wave_energy.maps import MIDDLE, MODELS, Largest
from reports.wave_energy.orders import SETTLED, SettledRun
from reports.wave_energy.sweep import Sweep
from tethertest.records.waves import OrderWaves

#: frequencies of the tables [Hz]; the CSV files hold all
PRINTED: Final = (0.06, 0.10, 0.12, *FIGURE_8[:1], 0.16, 0.18, 0.19, 0.21, 0.24, 0.26, 0.30, 0.36, 0.40)
COMMAND: Final = "python -m reports.wave_energy"


def page(sweep: Sweep) -> str:
    """Return the report."""
    naturals = ", ".join(f"{natural:.3f}" for natural in sweep.naturals)
    parts = [
        "# Waves, their energy and the largest tension along the article's cable",
        f"Written by `{COMMAND}`. The cable is condition 1.1 of the source article (Tao & Zhang, Drones "
        "2022, 6(11), 349): 250 m at 80 N, its bottom driven along the cable by 2 m. Natural frequencies "
        "of the "
        f"article's equations, both ends held: {naturals} Hz.",
        "## What the article says, and what holds",
        "\n".join(f"- {line}" for line in answers(sweep)),
        "## What is counted",
        "Dynamic tension is the tension less that of rest. Along and across are the directions of the cable "
        "at rest. The part of the force along it and the velocity along it make the axial waves, the part "
        "across and the velocity across the transverse ones: `up = (F - Z v)/2`, `down = (F + Z v)/2`, Z "
        "being mass per length times the speed of each kind. Each carries `amplitude^2/2Z`; the difference "
        "of both, over both kinds and all orders, is the power through a section, and at the bottom the work "
        "of the drive. The energy ratio is that of the weaker wave over the stronger one: 1 standing, 0 "
        "travelling, one third where both parts hold the same energy. An amplitude's error is the "
        "difference of the two halves of the window; an order within 2.8 of it is left out. A run counts as "
        f"settled where both halves' axial forces agree to {SETTLED:.0%}.",
        "## From the article's start",
        "The bottom moves at full velocity at once, and nothing takes energy out: the free motion of the "
        "start never dies. 2048 samples at 30 Hz, "
        + "; ".join(f"**{name}**: {text}" for name, text in MODELS.items())
        + ". One shape: the share of the mean square of F(s, t) that the best single shape holds; it is 1 "
        f"for a standing wave, 1/2 for one that travels. Middle: {MIDDLE[0]:g} to {MIDDLE[1]:g} of the "
        "length. "
        f"Half the mesh changes the exact cable's largest tensions by {sweep.mesh_largest:.1%} at most.",
        "![Dynamic tension over time and place](fig8.png)",
        "![The largest tension of each instant around the largest of all](largest.png)",
        _started_table(sweep),
        "## Settled",
        f"The drive is ramped up over {RAMP:g} s; 20 periods follow, of the geometrically exact cable. Half "
        f"the mesh changes the energy ratio at the bottom by {sweep.mesh_ratio:.3f} (0.24 Hz, air). Phase: "
        "periods since the bottom last went up through its middle, so that the bottom is highest at 0.25.",
        "![Place of the largest tension, share of one shape and energy ratio against the drive](sweep.png)",
    ]
    for what in CASES:
        parts += [f"### {what.name}: {what.text}", _settled_table(sweep.of_case(what.name))]
    parts += [
        "## Orders",
        "Axial waves at half the length, of the orders that come to 0.1 % of the first. All sections, both "
        "kinds and all frequencies are in `waves.csv`, the tables above in full in `started.csv` and "
        "`settled.csv`.",
        _orders_table(sweep),
    ]
    return "\n\n".join(parts) + "\n"


def _started_table(sweep: Sweep) -> str:
    heads = ["drive Hz"]
    for name in MODELS:
        heads += [f"{name}: place", "time s", "N", "middle over ends", "one shape"]
    rows = []
    for frequency in _printed(sweep):
        row = [f"{frequency:.2f}"]
        for model in MODELS:
            run = sweep.start(frequency, model)
            row += [*_where(run.largest), f"{run.share:.2f}"]
        rows.append(row)
    return markdown(heads, rows)


def _printed(sweep: Sweep) -> list[float]:
    known = {run.frequency for run in sweep.started}
    return [frequency for frequency in PRINTED if frequency in known]


def _where(found: Largest) -> tuple[str, str, str, str]:
    return f"{found.place:.2f}", f"{found.time:.1f}", f"{found.value:.1f}", f"{found.middle_over_ends:.2f}"


def _settled_table(runs: Sequence[SettledRun]) -> str:
    heads = (
        "drive Hz", "bottom, axial: up N", "down N", "up W", "down W", "energy ratio", "standing-wave ratio",
        "middle, axial: energy ratio", "transverse: up N", "down N", "drive's work W", "out at the top W",
        "largest: place", "phase", "N", "middle over ends", "settled",
    )  # fmt: skip
    rows = []
    for run in runs:
        if run.frequency not in PRINTED:
            continue
        bottom, middle = run.order(0.0), run.order(0.5)
        across = run.order(0.5, across=True)
        found = run.largest
        rows.append(
            (
                f"{run.frequency:.2f}",
                *_both(bottom),
                *_powers(run, bottom),
                _ratio(bottom),
                _standing(bottom),
                _ratio(middle),
                *_both(across),
                f"{_zero(run.work):.3f}",
                f"{_zero(run.arriving):.3f}",
                f"{found.place:.2f}",
                f"{found.phase:.2f}",
                f"{found.value:.1f}",
                f"{found.middle_over_ends:.2f}",
                "yes" if run.is_settled else f"no ({run.change:.0%})",
            )
        )
    return markdown(heads, rows)


def _both(waves: OrderWaves | None) -> tuple[str, str]:
    return ("-", "-") if waves is None else (f"{waves.up:.2f}", f"{waves.down:.2f}")


def _powers(run: SettledRun, waves: OrderWaves | None) -> tuple[str, str]:
    if waves is None:
        return "-", "-"
    twice = 2.0 * run.impedance
    return f"{waves.up**2 / twice:.3f}", f"{waves.down**2 / twice:.3f}"


def _ratio(waves: OrderWaves | None) -> str:
    return "-" if waves is None else f"{waves.energy_ratio:.3f}"


def _standing(waves: OrderWaves | None) -> str:
    return "-" if waves is None else f"{waves.standing_wave_ratio:.3g}"


def _zero(power: float) -> float:
    """Return a power without the sign of a rounded zero."""
    return 0.0 if abs(power) < 5e-4 else power


def _orders_table(sweep: Sweep) -> str:
    heads = ("drive Hz", "case", "order", "Hz", "up N", "down N", "energy ratio", "standing-wave ratio")
    rows = []
    for what in CASES:
        for run in sweep.of_case(what.name):
            if run.frequency in FIGURE_8:
                middle = next(section for section in run.sections if section.at == 0.5)
                rows += [
                    (
                        f"{run.frequency:.2f}",
                        what.name,
                        waves.order,
                        f"{waves.frequency:.3g}",
                        f"{waves.up:.3g}",
                        f"{waves.down:.3g}",
                        _ratio(waves),
                        _standing(waves),
                    )
                    for waves in middle.along
                ]
    return markdown(heads, rows)


def markdown(heads: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """Return a Markdown table."""
    return "\n".join("| " + " | ".join(line) + " |" for line in (heads, ["---"] * len(heads), *rows))
