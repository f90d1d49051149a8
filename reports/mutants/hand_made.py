"""Faults that no operator makes: terms dropped, factors halved, arguments swapped, guards removed.

Each stands in hand_made.toml as a text of one file and what takes its place.
"""

from __future__ import annotations

import tomllib
from pathlib import Path

from reports.mutants.sites import Mutant, mutant

FILE = Path(__file__).with_name("hand_made.toml")


def hand_made(root: Path, packages: tuple[str, ...]) -> tuple[list[Mutant], list[str]]:
    """Return the mutants of these packages, and what of the list no longer stands in the code.

    Parameters
    ----------
    root : Path
        Of the repository.
    packages : tuple of str
        Folders of ``tethertest``.
    """
    with FILE.open("rb") as file:
        entries = tomllib.load(file)["mutant"]
    found, gone = [], []
    for item in entries:
        if item["package"] not in packages:
            continue
        made = _planted(root, item["package"], item["before"], item["after"])
        if made is None:
            gone.append(f"{item['package']}: {item['before'].strip()}")
        else:
            found.append(made)
    return found, gone


def _planted(root: Path, package: str, before: str, after: str) -> Mutant | None:
    """Return the mutant where exactly one place of the package has the text, wherever the file now lies."""
    holders = [
        (path, source)
        for path in sorted((root / "tethertest" / package).rglob("*.py"))
        if before in (source := path.read_text(encoding="utf-8"))
    ]
    if len(holders) != 1 or holders[0][1].count(before) != 1:
        return None
    path, source = holders[0]
    return mutant(root, package, path, source.replace(before, after))
