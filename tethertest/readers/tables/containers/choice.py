"""Which of the tables in a tree is the log: as run.toml says, else the only one."""

from __future__ import annotations

from dataclasses import dataclass, replace

from tethertest.errors import FileFormatError
from tethertest.readers.tables.containers.assembly import assembled
from tethertest.readers.tables.containers.table import Column, Table, listed, toml_text
from tethertest.readers.tables.containers.tree import Branch, Leaf, Records, Tree
from tethertest.readers.tables.time_units import is_time_name
from tethertest.records.run import Log

#: path of the file itself, where the arrays are in no group
ROOT = "/"
#: tables that a message lists
_SHOWN = 8


@dataclass(frozen=True, slots=True, eq=False)
class Candidate:
    """One table that the file may mean."""

    name: str
    branch: Branch
    leaves: tuple[Leaf, ...]
    records: Records | None = None

    @property
    def names(self) -> set[str]:
        """Names of what it holds."""
        return set(self.records.names) if self.records else {leaf.name for leaf in self.leaves}

    def __str__(self) -> str:
        if self.records:
            return f"{self.name!r} ({len(self.records.names)} columns of {self.records.length})"
        sizes = [f"{leaf.name} {'x'.join(map(str, leaf.shape))}" for leaf in self.leaves]
        more = ", ..." if len(sizes) > 3 else ""
        return f"{self.name!r} ({', '.join(sizes[:3])}{more})"


def table_of(tree: Tree, settings: Log) -> tuple[Table, Log]:
    """Choose the table and load it.

    Parameters
    ----------
    tree : Tree
        What the file holds.
    settings : Log
        Its `table` names a group, struct, array or object; its `time` may be a path too.

    Returns
    -------
    tuple
        The table, and the settings with the keys that are already used taken out.

    Raises
    ------
    FileFormatError
        The file holds no table or several, or what the settings name is not there.
    """
    candidates = _candidates(tree)
    if settings.table is not None:
        chosen = _named(tree, candidates, settings.table)
    else:
        chosen = _only(tree, candidates, settings)
    if settings.time is not None:
        chosen, settings = _with_time(tree, chosen, settings, settings.time)
    elif len(chosen.leaves) == 1 and settings.rate is None:
        chosen = _with_sibling(chosen)
    if chosen.records:
        columns: tuple[Column, ...] = chosen.records.load()
        table = Table(tree.path, columns, named=True, facts=chosen.branch.facts)
    else:
        table = assembled(tree, chosen.name, chosen.leaves, chosen.branch.facts, settings)
        settings = replace(settings, columns=())
    remarks = [f"{name!r} {why} and is left out" for name, why in list(tree.left_out.items())[:_SHOWN]]
    return replace(table, remarks=(*table.remarks, *remarks)), settings


def _candidates(tree: Tree) -> list[Candidate]:
    found = []
    for branch in tree.branches:
        if branch.leaves:
            found.append(Candidate(branch.path or ROOT, branch, branch.leaves))
        found += [Candidate(tree.joined(branch, item.name), branch, (), item) for item in branch.records]
    return found


def _named(tree: Tree, candidates: list[Candidate], wanted: str) -> Candidate:
    key = wanted.strip("/") or ROOT
    for candidate in candidates:
        if candidate.name == key:
            return candidate
    for branch in tree.branches:
        for leaf in branch.leaves:
            if tree.joined(branch, leaf.name) == key:
                return Candidate(key, branch, (leaf,))
    if key in tree.left_out:
        message = f"run.toml says table = {toml_text(wanted)}, which {tree.left_out[key]}"
        raise FileFormatError(message, _remedy(candidates), path=tree.path)
    known = [candidate.name for candidate in candidates]
    message = (
        f"run.toml says table = {toml_text(wanted)}, but {tree.what} holds {listed(known) or 'no table'}"
    )
    raise FileFormatError(message, _remedy(candidates), path=tree.path)


def _only(tree: Tree, candidates: list[Candidate], settings: Log) -> Candidate:
    if not candidates:
        left_out = "; ".join(f"{name!r} {why}" for name, why in list(tree.left_out.items())[:_SHOWN])
        message = f"{tree.what} holds no array of numbers" + (f": {left_out}" if left_out else "")
        raise FileFormatError(message, "export the channels as plain vectors of numbers", path=tree.path)
    fitting = candidates
    if len(candidates) > 1 and settings.time is not None:
        time = settings.time.strip("/")
        fitting = [
            item
            for item in candidates
            if time in item.names or time in {tree.joined(item.branch, name) for name in item.names}
        ] or candidates
    if len(fitting) == 1:
        return fitting[0]
    texts = ", ".join(map(str, fitting[:_SHOWN])) + (", ..." if len(fitting) > _SHOWN else "")
    message = f"{tree.what} holds {len(fitting)} tables that may be the log: {texts}"
    raise FileFormatError(message, _remedy(fitting), path=tree.path)


def _remedy(candidates: list[Candidate]) -> str:
    if not candidates:
        return "choose another file"
    lines = " or ".join(f"table = {toml_text(candidate.name)}" for candidate in candidates[:4])
    return f"write for this log in run.toml: {lines}"


def _with_time(tree: Tree, chosen: Candidate, settings: Log, time: str) -> tuple[Candidate, Log]:
    """Return the table with the vector that run.toml names as its time, wherever in the file it is."""
    if time in chosen.names or chosen.records:
        return chosen, settings
    beside = [leaf for leaf in chosen.branch.leaves if leaf.name == time]
    anywhere = [
        leaf
        for branch in tree.branches
        for leaf in branch.leaves
        if tree.joined(branch, leaf.name) == time.strip("/")
    ]
    for leaf in (*beside, *anywhere):
        if leaf in chosen.leaves:
            return chosen, replace(settings, time=leaf.name)
        others = tuple(item for item in chosen.leaves if item.name != leaf.name)
        return replace(chosen, leaves=(leaf, *others)), replace(settings, time=leaf.name)
    return chosen, settings


def _with_sibling(chosen: Candidate) -> Candidate:
    """Return a single array with the vector beside it that is called time and is as long."""
    (leaf,) = chosen.leaves
    times = [
        item
        for item in chosen.branch.leaves
        if item is not leaf
        and len(item.shape) == 1
        and is_time_name(item.name, item.unit)
        and item.shape[0] in leaf.shape
    ]
    return replace(chosen, leaves=(times[0], leaf)) if len(times) == 1 else chosen
