"""The run's own file, `run.toml`."""

from __future__ import annotations

from .campaign import Plan

OPERATORS = ("A. Technician", "B. Technician")


def operator(plan: Plan) -> str:
    """Return who stood at the rig."""
    return OPERATORS[plan.date.day % 2]


def log_names(plan: Plan) -> dict[str, str]:
    """Return the file name of each clock's log."""
    suffix = {"lvm": "lvm", "tdms": "tdms", "catman": "asc"}[plan.tension.split("-")[0]]
    return {"daq": f"tension.{suffix}", "interrogator": "fbg.txt", "encoder": "crank.csv"}


def run_card(plan: Plan) -> str:
    """Return the text of `run.toml`."""
    names = log_names(plan)
    rows = [
        f'id = "rig3m-{plan.name}"',
        f'title = "Synthetic: {plan.title}"',
        'rig = "rig3m"',
        f"date = {plan.date.isoformat()}",
        f'operator = "{operator(plan)}"',
        'purpose = "validation"',
        "",
        "[drive]",
    ]
    if plan.frequency:
        rows += [
            'kind = "crank-slider"',
            f'frequency = "{plan.frequency:g} Hz"',
            f'radius = "{plan.radius:g} m"',
        ]
    else:
        rows.append('kind = "none"')
    rows += [
        "",
        "[platform]",
        f'mode = "{plan.mode}"',
        "",
        "[[log]]",
        f'file = "{names["daq"]}"',
        'clock = "daq"',
        'channels = { F_top = "tension_top", F_bottom = "tension_bottom" }',
        "",
        "[[log]]",
        f'file = "{names["interrogator"]}"',
        'clock = "interrogator"',
        "",
        "[[log]]",
        f'file = "{names["encoder"]}"',
        'clock = "encoder"',
    ]
    return "\n".join(rows) + "\n"
