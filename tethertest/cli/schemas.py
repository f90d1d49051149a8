"""JSON schemas of the files that people write, and of what commands print, by name."""

from __future__ import annotations

from typing import Any, Final

from tethertest.bench.speed import Measured
from tethertest.jobs.draft import WrittenDraft
from tethertest.jobs.export import Export
from tethertest.jobs.ingest import Ingested
from tethertest.jobs.solve_summary import SolveSummary
from tethertest.records.inspected import Inspected
from tethertest.records.rig import Prototype, Rig
from tethertest.records.run import RunFile
from tethertest.records.scene import Scene
from tethertest.records.similarity import Similarity
from tethertest.render.across import PrintedAcross
from tethertest.render.analysis import WrittenAnalysis
from tethertest.render.as_json import file_schema, printed_schema
from tethertest.render.summary import PrintedSummary

#: kind of file -> its record
FILES: Final[dict[str, type]] = {"run": RunFile, "rig": Rig, "prototype": Prototype, "scene": Scene}
#: command -> the record of its ``--json``, or several of them
COMMANDS: Final[dict[str, Any]] = {
    "report": PrintedSummary,
    "analyze": WrittenAnalysis,
    "across": PrintedAcross,
    "inspect": Inspected,
    "solve": SolveSummary,
    "scale": Similarity,
    "ingest": Ingested,
    "export": Export,
    "new": WrittenDraft,
    "bench": Measured,
}
#: command -> keys that are not always there: files hold what is printed but for the paths of what was written
_MAY_LACK: Final = {"report": ("paths",), "analyze": ("paths",), "across": ("paths",)}


def schema_of(kind: str) -> dict[str, Any]:
    """Return the JSON Schema 2020-12 of a key of `FILES` or `COMMANDS`."""
    if kind in FILES:
        return file_schema(FILES[kind], f"tethertest {kind} file")
    words = "analyze --across" if kind == "across" else kind
    return printed_schema(COMMANDS[kind], f"tethertest {words} --json", _MAY_LACK.get(kind, ()))
