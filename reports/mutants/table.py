"""What became of the mutants, as a table and a list of those that nothing noticed."""

from __future__ import annotations

import tomllib
from collections.abc import Sequence
from pathlib import Path

from reports.mutants.sites import Mutant
from reports.mutants.trial import SURVIVED, Outcome

EQUIVALENT = Path(__file__).with_name("equivalent.toml")
HEAD = """# {title}

{how} Made by `{command}`; {survivors}.

| package | tried | killed | equivalent | survived | killed of those that are not equivalent |
|---|---|---|---|---|---|
"""


def reasons() -> dict[tuple[str, str, str], str]:
    """Return (file name, line before, line after) -> why the change changes nothing."""
    with EQUIVALENT.open("rb") as file:
        entries = tomllib.load(file)["mutant"]
    return {(item["file"], item["before"], item["after"]): item["reason"] for item in entries}


def table(outcomes: Sequence[Outcome], title: str, how: str, command: str) -> str:
    """Return the report in Markdown.

    Parameters
    ----------
    outcomes : sequence of Outcome
        Of all packages.
    title, how, command : str
        What was tried, how it was chosen, and the command that repeats it.
    """
    known = reasons()
    packages = sorted({item.mutant.package for item in outcomes})
    rows = [
        _row(name, [item for item in outcomes if item.mutant.package == name], known) for name in packages
    ]
    rows.append(_row("all", outcomes, known))
    left = [item.mutant for item in outcomes if item.killer == SURVIVED]
    unnoticed = [item for item in left if _key(item) not in known]
    survivors = f"{len(unnoticed)} went unnoticed" if unnoticed else "every one was noticed"
    text = HEAD.format(title=title, how=how, command=command, survivors=survivors) + "\n".join(rows) + "\n"
    if unnoticed:
        text += "\n## Survivors\n\n" + "".join(_entry(item) for item in unnoticed)
    equal = [item for item in left if _key(item) in known]
    if equal:
        text += "\n## Equivalent\n\n" + "".join(f"{_entry(item)}  {known[_key(item)]}\n" for item in equal)
    return text


def _row(name: str, outcomes: Sequence[Outcome], known: dict[tuple[str, str, str], str]) -> str:
    left = [item.mutant for item in outcomes if item.killer == SURVIVED]
    equal = sum(_key(item) in known for item in left)
    killed = len(outcomes) - len(left)
    share = killed / max(1, len(outcomes) - equal)
    return f"| {name} | {len(outcomes)} | {killed} | {equal} | {len(left) - equal} | {share:.0%} |"


def _key(mutant: Mutant) -> tuple[str, str, str]:
    return mutant.path.name, mutant.before, mutant.after


def _entry(mutant: Mutant) -> str:
    place = mutant.path.relative_to("tethertest")
    return f"- {place}: `{mutant.before}`\n  → `{mutant.after}`\n"
