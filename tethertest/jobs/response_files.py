"""A response as CSV or HDF5."""

from __future__ import annotations

import io
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from tethertest import __version__
from tethertest.errors import DataError
from tethertest.records.arrays import FloatArray
from tethertest.records.response import Response

#: field -> unit in column names, and in HDF5
FIELD_UNITS = {"position": ("m", "m"), "velocity": ("m_s", "m/s"), "curvature": ("1_m", "1/m")}
_AXES = ("x", "y", "z")


def response_writer(path: Path) -> Callable[[Response], bytes]:
    """Return what turns a response into the kind of file that a name stands for.

    Raises
    ------
    DataError
        The name ends with neither .csv nor .h5.
    """
    writers = {".csv": response_csv, ".h5": response_h5}
    writer = writers.get(path.suffix.lower())
    if writer is None:
        message = f"--output: found {path.name!r}, expected a name that ends with .csv or .h5"
        raise DataError(message, f"write -o {path.stem or 'out'}.csv, or -o {path.stem or 'out'}.h5")
    return writer


def response_csv(response: Response) -> bytes:
    """Return the response as CSV, one row per time.

    The columns are ``time_s, tension_N@0, ..., strain@0, ...``; then each field asked for, component by
    component: ``position_x_m@0, ..., velocity_x_m_s@0, ..., curvature_1_m@0, ...``.
    """
    gauges = [f"{gauge:g}" for gauge in response.gauges]
    names = ["time_s", *(f"tension_N@{g}" for g in gauges), *(f"strain@{g}" for g in gauges)]
    blocks: list[FloatArray] = [response.time[:, None], response.tension, response.strain]
    for field, values in response.fields.items():
        unit, _ = FIELD_UNITS[field]
        if values.ndim == 2:
            names += [f"{field}_{unit}@{g}" for g in gauges]
            blocks.append(values)
        else:
            for axis, name in enumerate(_AXES):
                names += [f"{field}_{name}_{unit}@{g}" for g in gauges]
                blocks.append(values[:, :, axis])
    text = io.BytesIO()
    table = np.column_stack(blocks)
    np.savetxt(text, table, fmt="%.9g", delimiter=",", header=",".join(names), comments="")
    return text.getvalue()


def response_h5(response: Response) -> bytes:
    """Return the response as HDF5: series at the gauges, fields, tension along the cable, slack.

    Every dataset has its unit in the attribute ``units``; scene, status, scheme and errors are attributes of
    the file, NaN where an error is not known.
    """
    import h5py

    memory = io.BytesIO()
    with h5py.File(memory, "w") as file:
        for name, values, unit in (
            ("time", response.time, "s"),
            ("gauges", response.gauges, "1"),
            ("tension", response.tension, "N"),
            ("strain", response.strain, "1"),
            ("platform_position", response.platform_position, "m"),
            ("field/time", response.field.time, "s"),
            ("field/position", response.field.position, "1"),
            ("field/maximum", response.field.maximum, "N"),
            ("field/minimum", response.field.minimum, "N"),
            *((f"fields/{name}", values, FIELD_UNITS[name][1]) for name, values in response.fields.items()),
            *((f"slack/{at:g}", np.reshape(spans, (-1, 2)), "s") for at, spans in response.slack.items()),
        ):
            _dataset(file, name, values, unit)
        file.attrs.update(_attributes(response))
        file.attrs["warnings"] = np.array(response.warnings, dtype=h5py.string_dtype())
    return memory.getvalue()


def _dataset(file: Any, name: str, values: Any, unit: str) -> None:
    array = np.asarray(values, dtype=np.float64)
    packed = {"compression": "gzip", "compression_opts": 1, "shuffle": True} if array.size > 1000 else {}
    file.create_dataset(name, data=array, **packed).attrs["units"] = unit


def _attributes(response: Response) -> dict[str, Any]:
    error = response.error
    return {
        "scene": response.scene.name,
        "status": response.status.name.lower(),
        "advice": response.status.value,
        "fidelity": response.fidelity,
        "scheme": response.scheme,
        "cells": response.cells,
        "time_step": response.time_step,
        "native_times": response.native_times,
        "error_numerical": error.numerical,
        "error_model": np.nan if error.model is None else error.model,
        "error_spread": np.nan if error.spread is None else error.spread,
        "error_peak": np.nan if response.snap is None or response.snap.error is None else response.snap.error,
        "tethertest": __version__,
    }
