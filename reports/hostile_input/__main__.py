"""``python -m reports.hostile_input [--only PATTERN] [-o DIR]``: the table; exit 1 where a case is missed."""

from __future__ import annotations

import argparse
import re
import sys
import tempfile
from pathlib import Path

from reports.hostile_input import process
from reports.hostile_input.case import Case
from reports.hostile_input.cases import CASES, MEMORY, SECONDS, faults, refusal
from tethertest.render.write import write_files

WHAT = f"""\
`python -m reports.hostile_input`: files and run folders that are made to do harm, each given to
`tethertest` in a process of its own. The memory is the sum of the largest memories of all its processes. A
case is met if the exit code is as expected (2: refused, 0: read right), the message names the file and what
to do, nothing of another file is told, there is no traceback, and it takes less than {SECONDS:.0f} s and
{MEMORY / 1e6:.0f} MB. Nothing is unpickled or evaluated: what would be, tells so. `make verify` runs the
same."""
#: signs of a message that are shown
_SHOWN = 110


def main(arguments: list[str]) -> int:
    """Try every case, print the table, write it where asked, and return the exit code."""
    parser = argparse.ArgumentParser(prog="python -m reports.hostile_input", description=__doc__)
    parser.add_argument("--only", default="", help="pattern of the cases' names")
    parser.add_argument("-o", "--output", type=Path, help="folder for the page")
    asked = parser.parse_args(arguments)
    rows, missed = [], []
    for case in CASES:
        if re.search(asked.only, case.title):
            row, wrong = tried(case)
            rows.append(row)
            if wrong:
                missed.append(f"- {_plain(case.title)}: {_plain('; '.join(wrong))}")
    lines = [
        "# Hostile input",
        "",
        WHAT,
        "",
        "| input | case | attack | size [kB] | command | what was said | exit | s | MB | |",
        "|---|---|---|---|---|---|---|---|---|---|",
        *rows,
        "",
        f"{len(rows) - len(missed)} of {len(rows)} cases are met.",
        *(["", *missed] if missed else []),
    ]
    page = "\n".join(lines) + "\n"
    sys.stdout.write(page)
    if asked.output is not None:
        write_files(asked.output, {"README.md": page.encode()})
    return 1 if missed else 0


def tried(case: Case) -> tuple[str, list[str]]:
    """Return a row of the table, and what is wrong."""
    with tempfile.TemporaryDirectory() as scratch:
        folder = Path(scratch)
        path = folder / case.file
        case.make(path)
        size = path.stat().st_size if path.is_file() else _size_of(path)
        done = process.run(tuple(word.replace("{}", case.file) for word in case.command), folder)
        written = "\n".join(made.read_text("utf-8") for made in folder.glob("run.csv"))
    wrong = faults(case, done, written)
    said = refusal(done.output + done.error) if done.code else "read"
    cells = [
        case.kind, case.name, case.attack, f"{size / 1e3:.1f}", case.command[0], _first(said, scratch),
        str(done.code), f"{done.seconds:.1f}", f"{done.peak / 1e6:.0f}", "missed" if wrong else "met",
    ]  # fmt: skip
    return f"| {' | '.join(_plain(cell) for cell in cells)} |", wrong


def _size_of(folder: Path) -> int:
    """Return the bytes of a run folder's own files."""
    return sum(path.stat().st_size for path in folder.rglob("*") if path.is_file() and not path.is_symlink())


def _first(said: str, scratch: str) -> str:
    line = said.replace(f"{scratch}/", "").split("\n")[0]
    return line if len(line) <= _SHOWN else f"{line[:_SHOWN]}..."


def _plain(text: str) -> str:
    """Return a text that ends no cell, begins no markup, and is printed as it is."""
    safe = "".join(sign if sign.isprintable() else repr(sign)[1:-1] for sign in text)
    return re.sub(r"([|<>*_`\[\]])", r"\\\1", safe)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
