"""Results as series: the values of a parameter of a cable over the dates of the logs."""

from __future__ import annotations

import os
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .._errors import ConfigError, ShapeError
from .._fric import _unknown_name
from ._needs import need
from ._run import FleetRun, LogFailure
from ._store import Store

# What a log has not measured, but the model given has it.
_NOT_MEASURED = {"kept", "missing", "found"}
_NEEDED = ("robot", "cable", "parameter", "start", "value")
_OPTIONAL = ("operation", "standard_error", "state", "log", "log_hash", "error", "computed")


@dataclass(frozen=True)
class Values:
    """The values of one parameter, dates ascending."""

    robot: str
    cable: str
    parameter: str
    stamp_nanos: NDArray[np.int64]
    value: NDArray[np.float64]
    standard_error: NDArray[np.float64]
    logs: tuple[str, ...]


@dataclass(frozen=True)
class Gathered:
    """All series of a fleet, and what is in none."""

    operation: str
    series: tuple[Values, ...]
    failures: tuple[LogFailure, ...]
    undated: tuple[str, ...]
    """Logs whose clock has no date."""
    logs: int
    """Logs with results and a date."""


def gather(results: Any, operation: str | None) -> Gathered:
    """The series of results: a `FleetRun`, the address of a data set, or a table with the same columns."""
    table = _table(results)
    if operation is None and isinstance(results, FleetRun):
        operation = results.operation
    if "operation" in table.column_names:
        table, operation = _of_operation(table, operation)
    rows = _latest(table.to_pylist())
    failures = tuple(sorted({(row["log"], row["error"]) for row in rows if row.get("error") is not None}))
    good = [row for row in rows if row.get("error") is None]
    undated = tuple(sorted({str(row.get("log")) for row in good if row["start"] is None}))
    dated = [row for row in good if row["start"] is not None]
    keys: dict[tuple[str, str, str], list[dict[str, Any]]] = {}
    for row in dated:
        if row.get("state") not in _NOT_MEASURED and row["value"] is not None and np.isfinite(row["value"]) and _counts(row["parameter"]):
            keys.setdefault((row["robot"], row["cable"] or "platform", row["parameter"]), []).append(row)
    series = [_values(key, entries) for key, entries in keys.items()]
    count = len({(row["robot"], row["start"], row.get("log_hash")) for row in dated})
    ordered = tuple(sorted(series, key=lambda one: (one.robot, one.cable, one.parameter)))
    return Gathered(operation or "fit", ordered, tuple(LogFailure(*failure) for failure in failures), undated, count)


def _counts(parameter: str) -> bool:
    """Whether a parameter says something that no other says: the mean error goes with its rms."""
    return not parameter.endswith(".mae_n")


def _table(results: Any) -> Any:
    pa = need("pyarrow")
    if isinstance(results, FleetRun):
        results = results.results
    if isinstance(results, (str, os.PathLike)):
        table = Store(results).table()
    else:
        try:
            table = pa.table(results)
        except (TypeError, ValueError) as error:
            kind = type(results).__name__
            raise ShapeError(
                f"`results` is {kind}; give what fric.fleet.run returned, the address of its results or a table of them"
            ) from error
    missing = [name for name in _NEEDED if name not in table.column_names]
    if missing:
        raise ShapeError(f"`results` has no column {', '.join(missing)}; a table needs {', '.join(_NEEDED)}")
    table = table.select([name for name in (*_NEEDED, *_OPTIONAL) if name in table.column_names])
    start = table.column_names.index("start")
    stamps = table.column("start").cast(pa.timestamp("ns", tz="UTC") if table.schema.field(start).type != pa.int64() else pa.int64())
    return table.set_column(start, "start", stamps.cast(pa.int64()))


def _of_operation(table: Any, operation: str | None) -> tuple[Any, str]:
    compute = need("pyarrow.compute")
    there = sorted(set(table.column("operation").unique().to_pylist()))
    if operation is None:
        if len(there) > 1:
            raise ConfigError(f"`results` has {' and '.join(there)}; say by `operation` which of them is meant")
        operation = there[0] if there else "fit"
    if operation not in there:
        raise ConfigError(_unknown_name("operation in `results`", operation, there))
    return table.filter(compute.equal(table.column("operation"), operation)), str(operation)


def _latest(rows: list[dict[str, Any]]) -> list[dict[str, Any]]:
    """Of a log that was computed with several models, options or versions, what was computed last."""
    if not rows or "computed" not in rows[0] or "log_hash" not in rows[0]:
        return rows
    last: dict[tuple[str, str], Any] = {}
    for row in rows:
        log = row["robot"], row["log_hash"]
        last[log] = max(last.get(log, row["computed"]), row["computed"])
    return [row for row in rows if row["computed"] == last[row["robot"], row["log_hash"]]]


def _values(key: tuple[str, str, str], rows: list[dict[str, Any]]) -> Values:
    rows = sorted(rows, key=lambda row: row["start"])
    errors = [row.get("standard_error") for row in rows]
    return Values(
        *key,
        np.array([row["start"] for row in rows], dtype=np.int64),
        np.array([row["value"] for row in rows], dtype=np.float64),
        np.array([np.nan if error is None else error for error in errors], dtype=np.float64),
        tuple(str(row.get("log", "")) for row in rows),
    )
