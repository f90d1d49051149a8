"""What a bare log, a run folder or a run store is."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from tethertest.errors import TethertestError
from tethertest.pipeline.store_summary import describe_store
from tethertest.readers import load_run, read_log
from tethertest.readers.inspect import describe
from tethertest.store import is_store


def inspect_path(path: Path, rigs: Path | None = None) -> dict[str, Any]:
    """Describe a log, a run store, or every log of a run folder.

    Parameters
    ----------
    path : Path
        A log or a run store (no rig needed), or a run folder.
    rigs : Path, optional
        Folder of rig files.

    Raises
    ------
    TethertestError
        The path or a file in it cannot be read.
    """
    if is_store(path):
        return describe_store(path)
    if not path.is_dir():
        return describe(read_log(path))
    if not (path / "run.toml").is_file():
        message = "the folder has no run.toml"
        raise TethertestError(message, "name a run folder, or a single log", path=path)
    run = load_run(path, rigs)
    logs = [describe(read_log(run.folder / log.file, log)) for log in run.file.log]
    return {"run": run.file.id, "rig": run.rig.name, "logs": logs}
