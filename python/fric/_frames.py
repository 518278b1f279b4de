"""Logs as data frames and as a table for notebooks."""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

import numpy as np

from ._html import table as html_table
from ._results.base import counted

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


def table(log: Log) -> str:
    """Returns the size of the log, its signals, and the range of each cable's signals as HTML."""
    known = [name for name in ("sensor_force_n", "length_m", "speed_m_per_s", "reference_force_n") if name in log]
    rows = ((cable, *(_range(getattr(log, name)[:, place]) for name in known)) for place, cable in enumerate(log.cable_names))
    duration_s = log.time_s[-1] if len(log) else 0.0
    signals = ", ".join(log) or "none"
    return f"<p>{counted(len(log), 'row')}, {duration_s:.3f} s; signals: {signals}</p>" + html_table(("cable", *known), rows)


def _range(column: np.ndarray[Any, Any]) -> str:
    known = column[np.isfinite(column)]
    return f"{known.min():.4g} … {known.max():.4g}" if known.size else "–"
