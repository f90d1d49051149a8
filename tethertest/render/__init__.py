"""A report as a page and as JSON: formatting and drawing only, no numbers are made here."""

from tethertest.render.report import write_report
from tethertest.render.summary import summary

__all__ = ["summary", "write_report"]
