"""Parquet: one table per time base; units and provenance in the schema."""

from __future__ import annotations

import json
from importlib.util import find_spec
from typing import Any

import numpy as np

from tethertest.errors import TethertestError
from tethertest.jobs.exports.source import Exported, Series, TimeBase
from tethertest.records.channel import Flag
from tethertest.store.layout import SOURCE_TEXTS
from tethertest.store.whole import WholeFile


def check_parquet() -> None:
    """Refuse in plain words where the library is not installed.

    Raises
    ------
    TethertestError
        It is not.
    """
    if find_spec("pyarrow") is None:
        message = "Parquet files need the package pyarrow, which is not installed"
        remedy = "pip install 'tethertest[tables]', or export --to csv"
        raise TethertestError(message, remedy)


def write_parquet(file: WholeFile, run: Exported, base: TimeBase) -> None:
    """Write one table: time, then value and flags of each channel.

    Parameters
    ----------
    file : WholeFile
        An open file.
    run : Exported
        Its id, date, run and rig file go into the metadata of the schema.
    base : TimeBase
        The channels; a column's metadata has unit, kind, position, uncertainty, source and steps.
    """
    import pyarrow as pa
    import pyarrow.parquet as pq

    fields = [pa.field("time", pa.float64(), nullable=False, metadata={"unit": "s"})]
    for series in base.series:
        name = series.about.name
        fields.append(pa.field(name, pa.float64(), metadata=_about(series)))
        fields.append(pa.field(f"{name} flags", pa.uint16(), nullable=False, metadata=_flag_meanings()))
    schema = pa.schema(
        fields,
        metadata={
            "run": run.run,
            "title": run.title,
            "date": run.date.isoformat(),
            "run_file": run.header.run_file,
            "rig_file": run.header.rig_file,
            "software": json.dumps(run.header.software),
        },
    )
    with pq.ParquetWriter(file, schema, compression="zstd") as writer:
        for channels in base.blocks():
            columns: list[Any] = [channels[0].time]
            for channel in channels:
                columns += [channel.values, channel.flags.astype(np.uint16)]
            arrays = [pa.array(column, field.type) for column, field in zip(columns, fields, strict=True)]
            writer.write_table(pa.Table.from_arrays(arrays, schema=schema))
            file.check()


def _about(series: Series) -> dict[str, str]:
    channel = series.about
    said = {
        "unit": channel.unit,
        "kind": channel.kind,
        "uncertainty": repr(channel.uncertainty),
        "noise": repr(channel.noise),
    }
    if channel.at is not None:
        said["at"] = repr(channel.at)
    source = channel.source
    if source is not None:
        said |= {key: getattr(source, key) for key in SOURCE_TEXTS}
        said["steps"] = json.dumps(source.steps, ensure_ascii=False)
    return said


def _flag_meanings() -> dict[str, str]:
    return {(flag.name or "").lower(): str(int(flag)) for flag in Flag if flag}
