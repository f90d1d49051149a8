"""The report folder: everything composed in memory first, then written."""

from __future__ import annotations

from pathlib import Path

from tethertest.records.report import Report
from tethertest.render.as_json import json_text
from tethertest.render.summary import summary
from tethertest.render.write import write_files

PAGE_NAME = "report.html"
SUMMARY_NAME = "summary.json"


def write_report(report: Report, folder: Path) -> tuple[Path, ...]:
    """Write the page and the summary of a report.

    Parameters
    ----------
    report : Report
        What the main job found; the same report gives the same bytes.
    folder : Path
        Output folder, made if it does not exist.

    Returns
    -------
    tuple of Path
        What was written: ``report.html``, ``summary.json``.

    Raises
    ------
    TethertestError
        The folder cannot be made or written; nothing is left half-written.
    """
    from tethertest.render.page import page  # brings matplotlib, which the summary does without

    contents = {
        PAGE_NAME: page(report).encode("utf-8"),
        SUMMARY_NAME: json_text(summary(report), indent=2, sort_keys=True).encode("utf-8"),
    }
    return write_files(folder, contents)
