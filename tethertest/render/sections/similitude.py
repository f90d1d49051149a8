"""Model against prototype: groups, scale ratios, demands that conflict."""

from __future__ import annotations

from tethertest.records.report import Report
from tethertest.records.similarity import PiGroup
from tethertest.render.blocks import (
    Cell,
    Facts,
    Section,
    Sentence,
    Table,
    columns,
    row,
    table_or_sentence,
    texts,
)
from tethertest.render.text import number, power_product, words

_TONES = {"matched": "pass", "mild": "undecided", "violated": "fail", "irrelevant": "quiet"}


def similitude_section(report: Report) -> Section:
    """Return the table of groups with what belongs to it."""
    heading = "Similitude with the prototype"
    similarity = report.similarity
    if similarity is None:
        absent = "No similitude: the rig file names no prototype, or there was too little to compare it with."
        return Section("similitude", heading, (Sentence(absent),))
    table = Table(
        "Dimensionless groups (ratio: model over prototype)",
        columns("Group", "Formula", "#Model", "#Prototype", "#Ratio", "Level", "Meaning"),
        tuple(_group_row(group) for group in similarity.groups),
    )
    ratios = tuple((words(name), number(value)) for name, value in sorted(similarity.ratios.items()))
    blocks = (
        table_or_sentence(table, "No dimensionless group could be formed."),
        Facts("Scale ratios, prototype over model", ratios, "spread")
        if ratios
        else Sentence("No scale ratios were found."),
        *texts([_conflict(names) for names in similarity.conflicts], "Demands that cannot hold together"),
        *texts(similarity.remarks, "Remarks"),
    )
    return Section("similitude", heading, blocks)


def _group_row(group: PiGroup) -> tuple[Cell, ...]:
    return row(
        group.name,
        power_product(group.exponents),
        number(group.model),
        number(group.prototype),
        number(group.ratio, 3),
        Cell(group.level or "not rated", tone=_TONES.get(group.level, "quiet"), badge=True),
        Cell(group.meaning, tone="prose"),
    )


def _conflict(names: tuple[str, ...]) -> str:
    return "; ".join(names)
