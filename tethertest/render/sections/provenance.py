"""What the report was made from and with; nothing that changes from one run of the program to the next."""

from __future__ import annotations

from tethertest.records.report import Report
from tethertest.records.response import Response
from tethertest.render.blocks import (
    Block,
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
from tethertest.render.text import percent
from tethertest.units import format_quantity


def provenance_section(report: Report) -> Section:
    """Return solver, files, settings, software and the conditioning of every channel."""
    provenance = report.provenance
    blocks: tuple[Block, ...] = (
        *_solver(report.response),
        table_or_sentence(_files(report), "No file is on record."),
        table_or_sentence(_conditioning(report), "No channel was conditioned."),
        Facts("Settings", tuple(sorted(provenance.settings.items())) or (("settings", "none"),), "spread"),
        Facts("Software", tuple(sorted(provenance.software.items())) or (("software", "none"),), "spread"),
    )
    return Section("provenance", "Provenance", blocks)


def _solver(response: Response | None) -> tuple[Block, ...]:
    if response is None:
        return (Sentence("No replay: the scene could not be made or solved, so no solver is on record."),)
    error = response.error
    budget = (
        ("numerical", error.numerical),
        ("model", error.model),
        ("spread of unknown damping", error.spread),
    )
    pairs = (
        ("Outcome", response.status.value),
        ("Fidelity", response.fidelity),
        ("Scheme", response.scheme),
        ("Cells", str(response.cells)),
        ("Time step", format_quantity(response.time_step, "s")),
        ("Error of the tension", "; ".join(f"{name} {percent(v)}" for name, v in budget if v is not None)),
    )
    return (Facts("Solver", pairs), *texts(response.warnings, "Warnings of the solver"))


def _files(report: Report) -> Table:
    rows = tuple(row(name, Cell(digest, tone="code")) for name, digest in report.provenance.files)
    return Table("Files", columns("File", "SHA-256"), rows)


def _conditioning(report: Report) -> Table:
    rows = tuple(
        row(
            channel.name,
            channel.source.file,
            channel.source.reader,
            channel.source.unit_as_written or "none",
            channel.source.clock,
            Cell(" → ".join(channel.source.steps) or "none", tone="prose"),
        )
        for channel in report.measured.channels
        if channel.source is not None
    )
    headings = columns("Channel", "File", "Reader", "Unit as written", "Clock", "Steps")
    return Table("Conditioning", headings, rows)
