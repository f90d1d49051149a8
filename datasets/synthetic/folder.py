"""One run, from its plan to its folder."""

from __future__ import annotations

import hashlib
import json
from dataclasses import asdict
from importlib.metadata import version
from pathlib import Path
from typing import Any

import numpy as np

from . import statement
from .campaign import Plan
from .cards import log_names, operator, run_card
from .flaws import inject
from .instruments import Record, encoder, gratings, load_cells
from .logs_catman import write_catman
from .logs_encoder import write_iso, write_relative, write_split
from .logs_labview import write_lvm
from .logs_ni import write_tdms
from .logs_optical import write_peaks, write_sensors
from .noise import draw_clocks
from .rig import MODES, Rig
from .snaps import snaps
from .tether import COURANT, DIFFUSION, RECORD_RATE, Truth, simulate

DIGITS = 7


def true_signals(plan: Plan, rig: Rig, cells: int, cache: Path | None) -> Truth:
    """Return the run's true signals, from the cache where they are known.

    Parameters
    ----------
    plan, rig : Plan, Rig
        The run and the rig.
    cells : int
        Number of cable segments.
    cache : Path, optional
        Folder of true signals, each under a name made of everything that decides them.
    """
    motion = plan.motion
    decides = [asdict(rig), asdict(MODES[plan.mode]), asdict(motion), cells, plan.offset]
    decides += [plan.duration, COURANT, DIFFUSION, RECORD_RATE, version("moordyn")]
    key = hashlib.sha256(json.dumps(decides, sort_keys=True).encode()).hexdigest()[:20]
    stored = cache / f"{key}.npz" if cache else None
    if stored and stored.exists():
        with np.load(stored) as arrays:
            return Truth(**{name: arrays[name] for name in arrays.files})
    truth = simulate(rig, MODES[plan.mode], motion, plan.duration, cells, plan.offset)
    if stored:
        stored.parent.mkdir(parents=True, exist_ok=True)
        np.savez(stored, **asdict(truth))
    return truth


def make_run(plan: Plan, rig: Rig, target: Path, cache: Path | None) -> dict[str, Any]:
    """Write one run's folder and return what its `truth.json` says."""
    truth = true_signals(plan, rig, plan.cells, cache)
    other = true_signals(plan, rig, plan.other_cells, cache)
    clocks = draw_clocks(plan.number, plan.duration)
    records = {
        "daq": load_cells(plan, truth, clocks["daq"]),
        "interrogator": gratings(plan, truth, clocks["interrogator"]),
        "encoder": encoder(plan, clocks["encoder"]),
    }
    stated_clocks = statement.clocks(records)
    flaws = inject(plan, records)
    logs = _logs(plan, records)
    rest = truth.time == 0.0
    stated = {
        "synthetic": True,
        "made_by": "datasets/make_rig3m.py",
        "moordyn": version("moordyn"),
        "settings": statement.settings(plan, rig),
        "drive": statement.drive(plan),
        "platform": statement.platform(plan, rig),
        "clocks": stated_clocks,
        "windows": statement.windows(plan),
        "orders": statement.orders(plan, truth),
        "slack": statement.slack(plan, truth),
        "peaks": statement.peaks(plan, truth),
        "snaps": snaps(plan, rig, truth),
        "static": {
            "tension_top_N": truth.tension_top[rest][0],
            "tension_bottom_N": truth.tension_bottom[rest][0],
            "strain": truth.strain[:, 0],
        },
        "convergence": statement.convergence(plan, truth, other),
        "flaws": flaws,
        "instrument": {name: record.facts for name, record in records.items()},
        "logs": {names: len(data) for names, data in logs.items()},
    }
    folder = target / plan.name
    folder.mkdir(parents=True, exist_ok=True)
    for name, data in logs.items():
        (folder / name).write_bytes(data)
    (folder / "run.toml").write_text(run_card(plan), encoding="utf-8", newline="\n")
    text = json.dumps(_plain(stated), indent=1)
    (folder / "truth.json").write_text(_tight(text) + "\n", encoding="utf-8", newline="\n")
    return stated


def _logs(plan: Plan, records: dict[str, Record]) -> dict[str, bytes]:
    """Return the files of the three loggers."""
    names = log_names(plan)
    daq, optical, crank = records["daq"], records["interrogator"], records["encoder"]
    kind = plan.tension.split("-")[0]
    comma = plan.tension.endswith("comma")
    if kind == "lvm":
        tension = write_lvm(daq, plan.date, comma, operator(plan))
    elif kind == "tdms":
        tension = write_tdms(daq, plan.date, f"rig3m {plan.name}, synthetic")
    else:
        tension = write_catman(daq, plan.date, comma, plan.tension.endswith("kn"))
    if plan.optical == "peaks":
        strain = write_peaks(optical, plan.date)
    else:
        strain = write_sensors(optical, plan.date, metadata=plan.number % 2 == 0)
    if plan.encoder == "iso":
        height = write_iso(crank, plan.date, "swapped-date" in plan.flaws)
    elif plan.encoder == "split":
        height = write_split(crank, plan.date)
    else:
        height = write_relative(crank, plan.date)
    return {names["daq"]: tension, names["interrogator"]: strain, names["encoder"]: height}


def _plain(value: Any) -> Any:
    """Return a value as JSON knows it, numbers with `DIGITS` significant digits."""
    if isinstance(value, dict):
        return {key: _plain(part) for key, part in value.items()}
    if isinstance(value, np.ndarray):
        return _plain(value.tolist())
    if isinstance(value, list | tuple):
        return [_plain(part) for part in value]
    if isinstance(value, float | np.floating):
        return float(f"{float(value):.{DIGITS}g}")
    if isinstance(value, np.integer):
        return int(value)
    return value


def _tight(text: str) -> str:
    """Put lists of numbers on one row."""
    rows: list[str] = []
    open_list: list[str] = []
    for row in text.split("\n"):
        if open_list:
            open_list.append(row.strip())
            if row.strip().rstrip(",") == "]":
                rows.append(_joined(open_list))
                open_list = []
            elif row.strip().endswith(("[", "{", "}", "},")):
                rows += open_list[:1] + open_list[1:]
                open_list = []
        elif row.endswith("["):
            open_list = [row]
        else:
            rows.append(row)
    return "\n".join(rows)


def _joined(rows: list[str]) -> str:
    """Return one list on one row."""
    return rows[0] + " ".join(rows[1:-1]) + rows[-1]
