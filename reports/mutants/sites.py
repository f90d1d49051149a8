"""Where a module can be changed: cosmic-ray's operators, sampled by place with a seed."""

from __future__ import annotations

import ast
import random
from collections import defaultdict
from collections.abc import Iterator
from dataclasses import dataclass
from difflib import SequenceMatcher
from pathlib import Path
from typing import Final

#: what a slip of the pen does; operators that only make nonsense (`a << b` for `a + b`) are left out
OPERATORS: Final = (
    *(
        f"ReplaceBinaryOperator_{pair}"
        for pair in (
            *("Add_Sub", "Sub_Add", "Mul_Div", "Div_Mul", "Pow_Mul", "FloorDiv_Mul", "Mod_Add"),
            *("BitAnd_BitOr", "BitOr_BitAnd"),
        )
    ),
    *(
        f"ReplaceComparisonOperator_{pair}"
        for pair in (
            *("Lt_LtE", "Lt_GtE", "LtE_Lt", "LtE_Gt", "Gt_GtE", "Gt_LtE", "GtE_Gt", "GtE_Lt"),
            *("Eq_NotEq", "NotEq_Eq", "Is_IsNot", "IsNot_Is"),
        )
    ),
    *(f"ReplaceUnaryOperator_Delete_{name}" for name in ("USub", "Not", "Invert")),
    *("AddNot", "ReplaceTrueWithFalse", "ReplaceFalseWithTrue", "ReplaceAndWithOr", "ReplaceOrWithAnd"),
    *("ReplaceBreakWithContinue", "ReplaceContinueWithBreak", "NumberReplacer", "ZeroIterationForLoop"),
)


@dataclass(frozen=True, slots=True)
class Mutant:
    """A module with one fault in it."""

    package: str
    path: Path  #: of the module, in the repository
    line: int  #: from 1
    before: str  #: the line as it stands
    after: str  #: with the fault
    source: str  #: of the whole module, with the fault


def sample(root: Path, package: str, count: int, seed: int) -> list[Mutant]:
    """Return `count` mutants of a package: places drawn evenly, then one operator at each.

    Parameters
    ----------
    root : Path
        Of the repository.
    package : str
        Folder of ``tethertest``.
    count : int
        Mutants wanted; all places where there are fewer.
    seed : int
        The same seed draws the same mutants as long as the package does not change.
    """
    from cosmic_ray.mutating import mutate_code  # of the extra `mutants`
    from cosmic_ray.operators.provider import OperatorProvider

    draw = random.Random(f"{seed} {package}")
    places = [
        (path, options)
        for path in sorted((root / "tethertest" / package).rglob("*.py"))
        for options in _places(path.read_text(encoding="utf-8"))
    ]
    draw.shuffle(places)
    found: list[Mutant] = []
    for path, options in places:
        if len(found) == count:
            break
        operator, occurrence = draw.choice(options)
        source = path.read_text(encoding="utf-8")
        changed = mutate_code(source, OperatorProvider()[operator](), occurrence)
        if changed is not None and ast.dump(ast.parse(changed)) != ast.dump(ast.parse(source)):
            found.append(mutant(root, package, path, changed))
    return sorted(found, key=lambda item: (item.path, item.line))


def unchanged(root: Path, package: str) -> Mutant:
    """Return a mutant without a fault: tests that fail on it say nothing about the others."""
    path = root / "tethertest" / package / "__init__.py"
    return mutant(root, package, path, path.read_text(encoding="utf-8"))


def mutant(root: Path, package: str, path: Path, changed: str) -> Mutant:
    """Return the mutant of a module that has this changed source."""
    old, new = path.read_text(encoding="utf-8").splitlines(), changed.splitlines()
    blocks = SequenceMatcher(None, old, new, autojunk=False).get_opcodes()
    parts = [(first, last, begin, end) for tag, first, last, begin, end in blocks if tag != "equal"]
    before = " ".join(line.strip() for first, last, _, _ in parts for line in old[first:last]).strip()
    after = " ".join(line.strip() for _, _, begin, end in parts for line in new[begin:end]).strip()
    line = parts[0][0] + 1 if parts else 1
    return Mutant(package, path.relative_to(root), line, before, after, changed)


def _places(source: str) -> Iterator[list[tuple[str, int]]]:
    """Yield for each place that can be changed its (operator, occurrence)."""
    from cosmic_ray.ast import ast_nodes, get_ast
    from cosmic_ray.operators.provider import OperatorProvider

    nodes = list(ast_nodes(get_ast(source)))
    skipped = _not_run(source)
    places: dict[tuple[int, int], list[tuple[str, int]]] = defaultdict(list)
    for name in OPERATORS:
        operator = OperatorProvider()[name]()
        positions = (start for node in nodes for start, _ in operator.mutation_positions(node))
        for occurrence, start in enumerate(positions):
            if not any(first <= start < last for first, last in skipped):
                places[start].append((name, occurrence))
    yield from (places[start] for start in sorted(places))


def _not_run(source: str) -> list[tuple[tuple[int, int], tuple[int, int]]]:
    """Return where types stand, which are never evaluated, and what a record is made frozen by."""
    types: list[ast.expr | None] = []
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, ast.AnnAssign | ast.arg):
            types.append(node.annotation)
        elif isinstance(node, ast.FunctionDef):
            types.append(node.returns)
        elif isinstance(node, ast.ClassDef):
            types += node.decorator_list
    return [
        ((item.lineno, item.col_offset), (item.end_lineno or 0, item.end_col_offset or 0))
        for item in types
        if item is not None
    ]
