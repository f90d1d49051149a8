"""A run folder as the header of a run store, and back."""

from __future__ import annotations

import tomllib
from collections.abc import Mapping
from dataclasses import replace
from importlib.metadata import version
from pathlib import Path

from tethertest.errors import FileFormatError
from tethertest.jobs.provenance import provenance
from tethertest.readers.config.structure import structure, uncertainties
from tethertest.records.channel import RawLog
from tethertest.records.rig import Rig
from tethertest.records.run import Run, RunFile
from tethertest.store import StoreHeader


def store_header(run: Run, logs: Mapping[str, RawLog]) -> StoreHeader:
    """Return what a store says of a run beside its channels.

    Parameters
    ----------
    run : Run
        Its run file, rig file and prototype file are kept whole.
    logs : mapping of str to RawLog
        By `Log.key`, for their hashes.
    """
    made = provenance(run, logs, {})
    prototype = run.rig_path.with_name(f"{run.rig.prototype}.toml") if run.rig.prototype else None
    return StoreHeader(
        folder=run.folder.resolve().name,
        run_file=_text(run.folder / "run.toml"),
        rig=run.file.rig,
        rig_file=_text(run.rig_path),
        prototype_file=_text(prototype) if prototype is not None and prototype.is_file() else None,
        software={**made.software, "h5py": version("h5py")},
        inputs=made.files,
        described=_described(run),
    )


def run_of(header: StoreHeader, path: Path) -> Run:
    """Return the run that a store was made of, without its folder of logs.

    Parameters
    ----------
    header : StoreHeader
        As read.
    path : Path
        The store, for messages.

    Raises
    ------
    FileFormatError
        The texts in the store are no run and rig file of this version.
    """
    try:
        file, problems = structure(RunFile, tomllib.loads(header.run_file))
        tables = tomllib.loads(header.rig_file)
        rig, more = structure(Rig, tables)
    except tomllib.TOMLDecodeError as error:
        message = f"its run or rig file is no TOML: {error}"
        raise FileFormatError(message, "ingest the run again from its raw logs", path=path) from error
    if file is None or rig is None or problems or more:
        first = [*problems, *more][0]
        message = (
            f"its run or rig file is not one of this version: {'.'.join(map(str, first.key))}: {first.text}"
        )
        raise FileFormatError(message, "ingest the run again from its raw logs", path=path)
    whole = replace(rig, uncertainty=uncertainties(Rig, tables))
    return Run(Path(header.folder), file, whole, Path(f"{header.rig}.toml"))


def _described(run: Run) -> dict[str, str | float]:
    """Return the motion and what the run is called, for people who open the file elsewhere."""
    file, drive = run.file, run.file.drive
    said: dict[str, str | float | None] = {
        "id": file.id,
        "title": file.title,
        "date": file.date.isoformat(),
        "purpose": file.purpose,
        "platform_mode": file.platform.mode,
        "drive_kind": drive.kind,
        "drive_frequency_Hz": drive.frequency,
        "drive_radius_m": drive.radius,
        "drive_amplitude_m": drive.amplitude,
    }
    return {name: value for name, value in said.items() if value is not None}


def _text(path: Path) -> str:
    return path.read_bytes().decode("utf-8")
