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

# States of values that come from the given model and were not measured from the log.
_NOT_MEASURED = ["kept", "missing", "found"]
_NEEDED = ("robot", "cable", "parameter", "start", "value")
_COLUMNS = {
    "operation": "string",
    "robot": "string",
    "cable": "string",
    "parameter": "string",
    "start": "int64",
    "value": "double",
    "standard_error": "double",
    "state": "string",
    "log": "string",
    "log_hash": "string",
    "error": "string",
    "computed": "stamp",
    "model_hash": "string",
    "options": "string",
}


@dataclass(frozen=True)
class Values:
    """Values of one parameter, in ascending order of dates."""

    robot: str
    cable: str
    parameter: str
    stamp_nanos: NDArray[np.int64]
    value: NDArray[np.float64]
    standard_error: NDArray[np.float64]
    logs: tuple[str, ...]
    models: tuple[tuple[str | None, str | None], ...]
    """Model and options of each log, as far as they are known."""


@dataclass(frozen=True)
class Found:
    """Effect that a discovery has named on a cable, in some logs or in all."""

    robot: str
    cable: str
    kind: str
    logs: int
    """Number of logs in which it was named."""
    of_logs: int
    """Number of logs of the robot."""
    first_nanos: int
    """Start of the first log in which it was named."""


@dataclass(frozen=True)
class Gathered:
    """All series of a fleet, and the logs that belong to none."""

    operation: str
    series: tuple[Values, ...]
    failures: tuple[LogFailure, ...]
    undated: tuple[str, ...]
    """Logs whose clock has no date."""
    logs: int
    """Number of logs with results and a date."""
    found: tuple[Found, ...]
    """Effects that a discovery has named."""


def gather(results: Any, operation: str | None) -> Gathered:
    """Returns the series of results, which are a `FleetRun`, the address of a data set, or a table with the same columns."""
    table = _table(results)
    if operation is None and isinstance(results, FleetRun):
        operation = results.operation
    table, operation = _of_operation(table, operation)
    table = _latest(table)
    compute = need("pyarrow.compute")
    is_good = compute.is_null(table.column("error"))
    good = table.filter(is_good)
    failures = _failures(table.filter(compute.invert(is_good)), good)
    has_date = compute.is_valid(good.column("start"))
    undated = {str(log) for log in good.filter(compute.invert(has_date)).column("log").unique().to_pylist()}
    dated = good.filter(has_date)
    logs = dated.group_by(["robot", "start", "log_hash"]).aggregate([]).num_rows
    operation = operation or "fit"
    return Gathered(operation, _split(dated, operation), failures, tuple(sorted(undated)), logs, _found(dated))


def _found(table: Any) -> tuple[Found, ...]:
    """Returns the effects that a discovery has named, by robot, cable, and kind."""
    compute = need("pyarrow.compute")
    logs = table.group_by(["robot", "start", "log_hash"]).aggregate([]).column("robot").to_pylist()
    rows = table.filter(compute.equal(compute.fill_null(table.column("state"), ""), "found"))
    groups = rows.group_by(["robot", "cable", "parameter"]).aggregate([("start", "min"), ("start", "count")]).to_pylist()
    return tuple(
        Found(
            str(one["robot"]),
            str(one["cable"]),
            str(one["parameter"]).removeprefix("found."),
            int(one["start_count"]),
            logs.count(one["robot"]),
            int(one["start_min"]),
        )
        for one in sorted(groups, key=lambda one: (one["robot"], one["cable"], one["parameter"]))
    )


def _failures(failed: Any, good: Any) -> tuple[LogFailure, ...]:
    """Returns the logs without a result, each with its last error.

    A log has a result if its bytes have one, also by another model, or if its address has one that is newer than the error.
    """
    good_hashes = set(good.column("log_hash").unique().to_pylist()) - {None}
    newest = good.group_by("log").aggregate([("computed", "max")])
    good_since = {log: at for log, at in zip(*(newest.column(name).to_pylist() for name in ("log", "computed_max"))) if at is not None}
    last: dict[str, tuple[Any, str]] = {}
    for one in failed.select(["log", "log_hash", "error", "computed"]).to_pylist():
        log, computed = str(one["log"]), one["computed"]
        is_over = computed is not None and log in good_since and good_since[log] > computed
        if one["log_hash"] in good_hashes or is_over:
            continue
        if log not in last or (computed is not None and last[log][0] is not None and computed > last[log][0]):
            last[log] = (computed, str(one["error"]))
    return tuple(LogFailure(log, error) for log, (_, error) in sorted(last.items()))


def _split(table: Any, operation: str) -> tuple[Values, ...]:
    """Returns the series of a table, by robot, cable, and parameter."""
    pa, compute = need("pyarrow"), need("pyarrow.compute")
    measured = compute.invert(compute.is_in(table.column("state"), value_set=pa.array(_NOT_MEASURED)))
    # The mean error is redundant beside its rms, and the error before compensation beside the fitted parameters, if there are any.
    parameter = table.column("parameter")
    doubled = compute.ends_with(parameter, ".mae_n")
    if operation != "replay":
        doubled = compute.or_(doubled, compute.starts_with(parameter, "before."))
    apart = compute.invert(doubled)
    table = table.filter(compute.and_(compute.and_(measured, apart), compute.is_finite(table.column("value"))))
    table = table.sort_by([(name, "ascending") for name in ("robot", "cable", "parameter", "start")])
    robots, cables, parameters = (table.column(name).combine_chunks() for name in ("robot", "cable", "parameter"))
    codes = np.stack([name.dictionary_encode().indices.to_numpy() for name in (robots, cables, parameters)])
    edges = np.flatnonzero(np.any(np.diff(codes, axis=1) != 0, axis=0)) + 1
    bounds = [0, *edges.tolist(), table.num_rows] if table.num_rows else [0]
    start, value, error = (table.column(name).to_numpy() for name in ("start", "value", "standard_error"))
    logs, models, options = (table.column(name) for name in ("log", "model_hash", "options"))
    return tuple(
        Values(
            str(robots[begin]),
            str(cables[begin]),
            str(parameters[begin]),
            start[begin:end].copy(),
            value[begin:end].copy(),
            error[begin:end].copy(),
            tuple(str(log) for log in logs[begin:end].to_pylist()),
            tuple(zip(models[begin:end].to_pylist(), options[begin:end].to_pylist())),
        )
        for begin, end in zip(bounds, bounds[1:])
    )


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
    try:
        return _typed(table)
    except (pa.ArrowInvalid, pa.ArrowNotImplementedError) as error:
        raise ShapeError(f"a column of `results` is of another type than fric.fleet.run writes: {error}") from error


def _typed(table: Any) -> Any:
    """Returns the required columns in the types of the data set, with nulls for missing ones and the start in ns since 1970."""
    pa, compute = need("pyarrow"), need("pyarrow.compute")
    columns = {}
    for name, kind in _COLUMNS.items():
        column = table.column(name) if name in table.column_names else pa.nulls(table.num_rows)
        if name == "start" and not pa.types.is_integer(column.type):
            column = column.cast(pa.timestamp("ns", tz="UTC"))
        columns[name] = column.cast(pa.type_for_alias(kind) if kind != "stamp" else pa.timestamp("us", tz="UTC"))
    columns["cable"] = compute.fill_null(columns["cable"], "platform")
    return pa.table(columns)


def _of_operation(table: Any, operation: str | None) -> tuple[Any, str | None]:
    compute = need("pyarrow.compute")
    there = sorted(compute.drop_null(table.column("operation").unique()).to_pylist())
    if not there:
        return table, operation
    if operation is None:
        if len(there) > 1:
            raise ConfigError(f"`results` has {' and '.join(there)}; say by `operation` which of them is meant")
        operation = str(there[0])
    if operation not in there:
        raise ConfigError(_unknown_name("operation in `results`", operation, there))
    return table.filter(compute.equal(table.column("operation"), operation)), operation


def _latest(table: Any) -> Any:
    """Keeps only the newest result of a log that was computed with several models, options, or versions."""
    compute = need("pyarrow.compute")
    if table.column("computed").null_count or table.column("log_hash").null_count:
        return table
    last = table.group_by(["robot", "log_hash"]).aggregate([("computed", "max")])
    joined = table.join(last, ["robot", "log_hash"])
    return joined.filter(compute.equal(joined.column("computed"), joined.column("computed_max")))
