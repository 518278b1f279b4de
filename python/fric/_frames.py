"""Conversion of logs to data frames."""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from ._fric import Log


def columns(log: Log) -> dict[str, np.ndarray[Any, Any]]:
    """Returns one column per cable and coordinate: `length_m.cable1`, `position_m.x`, …"""
    table: dict[str, np.ndarray[Any, Any]] = {"stamp_nanos": log.stamp_nanos, "time_s": log.time_s}
    per_cable = ["sensor_force_n", "length_m", "speed_m_per_s", "reference_force_n"]
    per_axis = ["position_m", "orientation_xyzw", "outside_force_n", "outside_torque_nm"]
    for names, parts in [(per_cable, log.cable_names), (per_axis, "xyzw")]:
        for name in names:
            array = getattr(log, name)
            # Each column is copied: frames keep views, and views of a row-major array are slow.
            table.update({f"{name}.{part}": column.copy() for part, column in zip(parts, array.T)})
    return table


def frame(log: Log, library: str) -> Any:
    """Returns the log as a `DataFrame` of polars or pandas."""
    try:
        module = import_module(library)
    except ImportError as error:
        raise ImportError(f"Log.to_{library} needs {library}; install it with `pip install {library}`") from error
    return module.DataFrame(columns(log))
