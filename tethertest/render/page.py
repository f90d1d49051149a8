"""The page: one file that needs nothing else."""

from __future__ import annotations

from functools import cache

import jinja2
import matplotlib as mpl

from tethertest.records.report import Report
from tethertest.render.blocks import Block, Section, Sentence
from tethertest.render.figures.style import RC
from tethertest.render.sections.drawings import (
    along_section,
    bottom_section,
    spectra_section,
    strains_section,
    top_overlay,
)
from tethertest.render.sections.lines import line_table, lines_section
from tethertest.render.sections.metrics import events_section, metrics_section
from tethertest.render.sections.provenance import provenance_section
from tethertest.render.sections.quality import quality_section
from tethertest.render.sections.similitude import similitude_section
from tethertest.render.sections.verdict import head
from tethertest.render.selection import tension_pairs

TEMPLATE = "report.html"


def page(report: Report) -> str:
    """Return the report as one self-contained HTML page."""
    with mpl.rc_context(RC):  # type: ignore[arg-type]
        first = (top_overlay(report), _first_lines(report))
        sections = _sections(report)
    return _environment().get_template(TEMPLATE).render(head=head(report), first=first, sections=sections)


def _first_lines(report: Report) -> Block:
    pairs = tension_pairs(report)
    if not pairs:
        return Sentence("No lines: the rig file has no load cell.")
    return line_table(report, pairs[0].name)


def _sections(report: Report) -> tuple[Section, ...]:
    return (
        quality_section(report),
        metrics_section(report),
        bottom_section(report),
        strains_section(report),
        spectra_section(report),
        along_section(report),
        events_section(report),
        lines_section(report),
        similitude_section(report),
        provenance_section(report),
    )


@cache
def _environment() -> jinja2.Environment:
    return jinja2.Environment(
        loader=jinja2.PackageLoader("tethertest.render"),
        autoescape=True,
        undefined=jinja2.StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
