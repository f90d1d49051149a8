"""Run folders whose files lead out of the folder or never end; and what is exported."""

from __future__ import annotations

import os
import shutil
from collections.abc import Callable
from pathlib import Path
from typing import Any, Final

import numpy as np

from reports.hostile_input.case import GOOD, Case
from reports.hostile_input.process import ROOT

RUN_FILE: Final = """\
id = "rest-01"
title = "at rest"
rig = "rig3m"
date = 2026-09-05T14:20:00+08:00

[drive]
kind = "none"

[platform]
mode = "free"

[[log]]
file = {file}
clock = "daq"
"""
RIGS: Final = ROOT / "rigs"
INSPECT: Final = ("inspect", "{}", "--json", "--rigs", str(RIGS))
INGEST: Final = ("ingest", "{}", "-o", "run.h5", "--rigs", str(RIGS))
OWN_RIG: Final = ("inspect", "{}", "--json", "--rigs", "{}")
_PASSWD: Final = "root:|daemon:"


def run_file(text: str = "", file: str = '"log.csv"') -> str:
    return RUN_FILE.format(file=file) + text


def folder(text: str, beside: Callable[[Path], object] = lambda path: None) -> Callable[[Path], None]:
    """Return what makes a run folder of this run file, a sound log, and what `beside` adds."""

    def make(path: Path) -> None:
        path.mkdir()
        (path.parent / "outside.csv").write_text(GOOD, encoding="utf-8")
        (path / "log.csv").write_text(GOOD, encoding="utf-8")
        (path / "run.toml").write_text(text, encoding="utf-8")
        beside(path)

    return make


def in_place_of(name: str, target: str) -> Callable[[Path], None]:
    """Return what puts a link in place of a file of the run."""

    def beside(path: Path) -> None:
        (path / name).unlink(missing_ok=True)
        (path / name).symlink_to(target)

    return beside


def pipe(name: str) -> Callable[[Path], None]:
    def beside(path: Path) -> None:
        (path / name).unlink()
        os.mkfifo(path / name)

    return beside


def rig(change: Callable[[str], str], **files: str) -> Callable[[Path], None]:
    """Return what puts the rig, changed, into the run folder."""

    def beside(path: Path) -> None:
        (path / "rig3m.toml").write_text(change((RIGS / "rig3m.toml").read_text("utf-8")), encoding="utf-8")
        shutil.copy(RIGS / "prototype-150m.toml", path)
        for name, text in files.items():
            (path / name).write_text(text, encoding="utf-8")

    return beside


def calibrated(log: str) -> Callable[[str], str]:
    own = 'sensitivity = "2.013 mV/V +/- 0.002 mV/V"  # at the rated load\nrated = "100 N"\n'
    new = f'calibration = {{ log = "{log}", order = 1 }}\nexcitation = "5 V"\n'
    return lambda text: text.replace(own, new)


def renamed(name: str) -> Callable[[str], str]:
    return lambda text: text.replace('name = "tension_top"', f"name = {name}")


def load_cells(name: str) -> Callable[[Path], None]:
    """Return what makes a run of two load cells at rest, the upper one called as given in TOML."""

    def beside(path: Path) -> None:
        rig(renamed(name))(path)
        chance = np.random.default_rng(7)
        values = chance.normal(0.0, 0.015, (8000, 2)) + np.array([5.0, 3.6])
        rows = [f"{0.002 * row:.4f},{top:.5f},{low:.5f}" for row, (top, low) in enumerate(values.tolist())]
        (path / "log.csv").write_text(
            "\n".join(["time [s],F [N],tension_bottom [N]", *rows, ""]), encoding="utf-8"
        )

    return folder(run_file(f"channels = {{ F = {name} }}"), beside)


def _run(name: str, attack: str, make: Callable[[Path], object], said: str, **keys: Any) -> Case:
    keys = {"command": INSPECT, "never": _PASSWD, **keys}
    return Case("run", name, attack, "rest", make, said, **keys)


def _outside(name: str, file: str, **keys: Any) -> Case:
    return _run(
        name,
        "leaves the folder",
        folder(run_file(file=file)),
        "expected a file inside the run folder|no file",
        **keys,
    )


CASES: Final = (
    _outside("log ../outside.csv", '"../outside.csv"'),
    _outside("log /etc/passwd", '"/etc/passwd"'),
    _outside("log C:\\\\log.csv", "'C:\\log.csv'"),
    _outside("log \\\\\\\\host\\\\log.csv", "'\\\\host\\log.csv'"),
    _outside("log x/../../outside.csv", '"x/../../outside.csv"'),
    _outside("ingest of ../outside.csv", '"../outside.csv"', command=INGEST),
    _run(
        "a NUL in a log's name",
        "cuts texts",
        folder(run_file(file='"a\\u0000b"')),
        "which no file can be called",
    ),
    _run(
        "a log's name of 10^5 letters",
        "faults",
        folder(run_file(file=f'"{"n" * 10**5}"')),
        "no file can be called",
    ),
    _run(
        "a link out of the folder",
        "leaves the folder",
        folder(run_file(), in_place_of("log.csv", "../outside.csv")),
        "expected a file inside the run folder",
    ),
    _run(
        "a link to itself",
        "never ends",
        folder(run_file(), in_place_of("log.csv", "log.csv")),
        "inside the run folder|no such file",
    ),
    _run("a pipe as log", "waits", folder(run_file(), pipe("log.csv")), "has no such file"),
    _run(
        "/dev/zero as log",
        "never ends",
        folder(run_file(), in_place_of("log.csv", "/dev/zero")),
        "inside the run folder",
    ),
    _run(
        "ingest of /dev/zero",
        "never ends",
        folder(run_file(), in_place_of("log.csv", "/dev/zero")),
        "inside the run folder",
        command=INGEST,
    ),
    _run("run.toml is /dev/zero", "memory", folder("", in_place_of("run.toml", "/dev/zero")), "run.toml"),
    _run("run.toml is a pipe", "waits", folder("", pipe("run.toml")), "run.toml"),
    _run(
        "run.toml is /etc/passwd",
        "shows a file",
        folder("", in_place_of("run.toml", "/etc/passwd")),
        "not valid TOML",
        never="",
    ),
    _run(
        "run.toml of 50 MB",
        "time and memory",
        folder(run_file("# no\n" * 10**7)),
        "bytes, expected at most 1048576",
    ),
    _run(
        "60,000 keys",
        "time",
        folder(run_file("".join(f"key{n} = 1\n" for n in range(60_000)))),
        "50 problems",
    ),
    _run(
        "40,000 entries of a list", "time", folder(run_file("x = [" + "1,\n" * 40_000 + "]")), "unknown key"
    ),
    _run(
        "10,000 brackets",
        "the stack",
        folder("x = " + "[" * 10_000 + "]" * 10_000),
        "too long to read|nested",
    ),
    _run("300 brackets", "the stack", folder(run_file("x = " + "[" * 300 + "]" * 300)), "unknown key"),
    _run(
        "a table of 10,000 dots",
        "the stack",
        folder(run_file("[" + "a." * 10_000 + "a]\nx = 1\n")),
        "unknown key|too",
    ),
    _run(
        "1,000 tables in each other",
        "the stack",
        folder(run_file("x = " + "{a=" * 900 + "1" + "}" * 900)),
        "unknown key|too",
    ),
    _run(
        "a number of 10^5 digits", "time", folder(run_file("skip_rows = " + "9" * 10**5)), "too long to read"
    ),
    _run(
        "skip_rows = 10^18",
        "time",
        folder(run_file("skip_rows = 1000000000000000000")),
        "expected 0 or more rows",
    ),
    _run("a rate of 1e999 Hz", "faults", folder(run_file('rate = "1e999 Hz"')), "not a finite number"),
    _run(
        "a rate of 1 9**9**9**9",
        "time",
        folder(run_file('rate = "1 Hz*9**9**9**9"')),
        "cannot be read|expected",
        slow=True,
    ),
    _run("encoding = idna", "faults", folder(run_file('encoding = "idna"')), "no known encoding"),
    _run("encoding = zlib", "unpacks", folder(run_file('encoding = "zlib"')), "no known encoding"),
    _run(
        "time_zone = ../../etc/passwd",
        "reads another file",
        folder(run_file('time_zone = "../../../../etc/passwd"')),
        "expected a time zone",
    ),
    _run(
        "rig = ../../x",
        "leaves the folder",
        folder(run_file().replace('"rig3m"', '"../../x"')),
        "expected the name of a rig",
    ),
    _run(
        "keys called __class__",
        "changes objects",
        folder(run_file('__class__ = "os"\n__init__ = 1\n')),
        "unknown key",
    ),
    _run("a key twice", "shows another one", folder(run_file('clock = "daq"\n')), "not valid TOML"),
    _run(
        "escape signs in a name",
        "the terminal",
        folder(run_file(file='"\\u001b[2J.csv"')),
        r"found '\\\\x1b\[2J.csv'",
    ),
    _run(
        "calibration /etc/passwd",
        "shows a file",
        folder(run_file(), rig(calibrated("/etc/passwd"))),
        "calibration",
        command=OWN_RIG,
    ),
    _run(
        "calibration ../outside.csv",
        "leaves the folder",
        folder(run_file(), rig(calibrated("../outside.csv"))),
        "calibration",
        command=OWN_RIG,
    ),
    _run(
        "calibration is a link to /dev/zero",
        "memory",
        folder(
            run_file(),
            lambda path: (rig(calibrated("cal.csv"))(path), in_place_of("cal.csv", "/dev/zero")(path)),
        ),
        "cal.csv",
        command=OWN_RIG,
    ),
    _run(
        "calibration is a pipe",
        "waits",
        folder(
            run_file(),
            lambda path: (rig(calibrated("cal.csv"), **{"cal.csv": ""})(path), pipe("cal.csv")(path)),
        ),
        "cal.csv",
        command=OWN_RIG,
    ),
    _run(
        "calibration of 1e999 and a formula",
        "is evaluated",
        folder(
            run_file(), rig(calibrated("cal.csv"), **{"cal.csv": "measured [mV/V],real [N]\n=1+1,1e999\n"})
        ),
        "found '=1\\+1', expected a number",
        command=OWN_RIG,
    ),
    Case("pipe", "a pipe", "waits", "log.csv", os.mkfifo, "found a pipe or a device"),
    Case(
        "pipe",
        "a link to /dev/zero",
        "never ends",
        "log.csv",
        lambda path: path.symlink_to("/dev/zero"),
        "found a pipe or a device",
    ),
    *(
        Case(
            "export",
            f"a sensor called {name[:24]}",
            "is a formula",
            "rest",
            load_cells(name),
            said,
            refused=False,
            command=("export", "{}", "-o", "run.csv", "--rigs", "{}"),
            never=never,
            slow=True,
        )
        for name, said, never in (
            ('"=1+1"', "run.csv", "(^|,)=1"),
            ('"@SUM(A1)"', "run.csv", "(^|,)@"),
            ("\"+cmd|' /C calc'!A0\"", "run.csv", "(^|,)\\+"),
            ('" -2+3"', "run.csv", "(^|,) *-2"),
            ('"\\t=1"', "run.csv", "(^|,)\\s*="),
            ('"a\\n=1"', "run.csv", "(^|,)="),
        )
    ),
    *(
        Case(
            "store",
            f"a sensor called {title}",
            "the store",
            "rest",
            load_cells(name),
            "2 channels",
            refused=False,
            command=("ingest", "{}", "-o", "run.h5", "--rigs", "{}"),
            slow=True,
        )
        for title, name in (
            ("../../x", '"../../x"'),
            ("a line break", '"a\\nb"'),
            ("..", '".."'),
            ("a NUL", '"a\\u0000b"'),
            ("5,000 letters", f'"{"n" * 5000}"'),
        )
    ),
)
