"""The parts of the page that are figures, or the sentence that says why one is missing."""

from __future__ import annotations

from tethertest.records.lines import EventKind
from tethertest.records.report import Report
from tethertest.render.blocks import Block, Section, Sentence
from tethertest.render.figures.along import along_figure
from tethertest.render.figures.field import field_map
from tethertest.render.figures.overlay import tension_overlay
from tethertest.render.figures.spectra import spectra_figure, spectra_panels
from tethertest.render.figures.strains import strain_overlays
from tethertest.render.selection import (
    Pair,
    analysed_window,
    cycles_window,
    drive_frequency,
    strain_pairs,
    tension_pairs,
    whole_window,
)


def top_overlay(report: Report) -> Block:
    """Return the overlay of the load cell nearest to the top, for the first screen."""
    pairs = tension_pairs(report)
    if not pairs:
        return Sentence("No overlay: the rig file has no load cell.")
    return _overlay(report, pairs[0], first_screen=True)


def bottom_section(report: Report) -> Section:
    """Return the overlays of the other load cells."""
    blocks = tuple(_overlay(report, pair) for pair in tension_pairs(report)[1:])
    absent = Sentence("The rig file has one load cell at most; there is no second tension to show.")
    return Section("bottom", "Bottom tension", blocks or (absent,))


def strains_section(report: Report) -> Section:
    """Return the small multiples of the gratings."""
    pairs = strain_pairs(report)
    shown = [pair for pair in pairs if _there(pair)]
    missing = ", ".join(pair.name for pair in pairs if not _there(pair))
    blocks: list[Block] = []
    if shown:
        blocks.append(
            strain_overlays(shown, whole_window(report), cycles_window(report), drive_frequency(report))
        )
    if not pairs:
        blocks.append(Sentence("The rig file has no strain grating."))
    if missing:
        blocks.append(Sentence(f"No usable sample, and nothing was replayed there: {missing}."))
    return Section("strains", "Strains", tuple(blocks))


def spectra_section(report: Report) -> Section:
    """Return the spectra of load cells and gratings."""
    window = analysed_window(report)
    pairs = (*tension_pairs(report), *strain_pairs(report))
    panels = spectra_panels(pairs, window)
    if not panels:
        return Section("spectra", "Spectra", (Sentence("No spectra: no channel could be used."),))
    lines = {lines.channel: lines for lines in report.measured_lines}
    blocks: list[Block] = [spectra_figure(panels, lines, window, drive_frequency(report))]
    missing = {pair.name for pair in pairs} - {panel.name for panel in panels}
    if missing:
        blocks.append(Sentence(f"No spectrum, for want of usable samples: {', '.join(sorted(missing))}."))
    return Section("spectra", "Spectra", tuple(blocks))


def along_section(report: Report) -> Section:
    """Return the map of tension along the cable and its extremes."""
    heading = "Tension along the cable"
    response = report.response
    if response is None:
        absent = "Nothing was replayed, so there is no tension along the cable to show."
        return Section("along", heading, (Sentence(absent),))
    length = response.scene.cable.length
    whole, cycles = whole_window(report), cycles_window(report)
    blocks: list[Block] = [field_map(response.field, length, whole, cycles, drive_frequency(report))]
    cells, gratings = tension_pairs(report), strain_pairs(report)
    blocks.append(along_figure(cells, gratings, response, analysed_window(report)))
    if response.scene.cable.axial_stiffness is None and gratings:
        text = "The gratings are not in the second figure: the rig file does not give the axial stiffness."
        blocks.append(Sentence(text))
    return Section("along", heading, tuple(blocks))


def _overlay(report: Report, pair: Pair, *, first_screen: bool = False) -> Block:
    if not _there(pair):
        return Sentence(
            f"No overlay of {pair.name}: the run has no usable sample of it, and nothing was replayed there."
        )
    slack = [event for event in report.events if event.kind == EventKind.SLACK]
    return tension_overlay(
        pair,
        whole_window(report),
        cycles_window(report),
        slack,
        drive_frequency(report),
        first_screen=first_screen,
    )


def _there(pair: Pair) -> bool:
    return any(channel is not None and channel.usable.any() for channel in (pair.measured, pair.replayed))
