"""Work on one log by a worker."""

from __future__ import annotations

import hashlib
import json
import os
import time
import warnings
from collections.abc import Mapping
from dataclasses import dataclass, replace
from datetime import datetime, timezone
from pathlib import Path
from typing import Any, Literal

import numpy as np

from .._errors import ConfigError, FitError, LogError, ShapeError
from .._fric import Log, Robot, __version__, read_log
from ._errors import FleetError
from ._logs import LogAddress, content_hash, fetched
from ._needs import need
from ._operations import rows_of
from ._store import Store

# Errors caused by the bytes of the log, which are the same each time. Any other error, such as a full disk, may not recur.
_OF_THE_LOG = (LogError, FitError, ShapeError, ConfigError)
# A recorder whose clock begins at 0 when it is switched on gives times within the first year of Unix time. These are not dates.
_FIRST_DATE_NANOS = 365 * 86_400 * 10**9


@dataclass(frozen=True)
class Job:
    """Operation on one log."""

    operation: str
    log: LogAddress
    model: str | None
    """Text of the robot file; None if the log has its own."""
    options: Mapping[str, Any]
    results: str
    key: str
    version: str


@dataclass(frozen=True)
class Outcome:
    """Outcome of a job."""

    log: LogAddress
    state: Literal["computed", "known", "failed", "wrong_call"]
    log_hash: str | None = None
    error: str | None = None


def work(job: Job) -> Outcome:
    """Reads a log, runs the operation on it, and writes the result. An error of the log is reported in the returned outcome."""
    if job.version != __version__:
        text = f"a worker has fric {__version__}, this is {job.version}; install the same version everywhere"
        return Outcome(job.log, "wrong_call", error=text)
    _one_thread_a_task()
    state = _State()
    try:
        with fetched(job.log.address) as path:
            return _of_file(job, path, state)
    except ConfigError as error:
        # A given model is the same for all logs; an attached one belongs to its log.
        if job.model is not None:
            return Outcome(job.log, "wrong_call", state.log_hash, str(error))
        return _failed(job, state, error)
    except Exception as error:  # noqa: BLE001
        return _failed(job, state, error)


@dataclass
class _State:
    """Progress of a job."""

    log_hash: str | None = None
    robot: Robot | None = None
    log: Log | None = None
    path: str | None = None


def _of_file(job: Job, path: Path, state: _State) -> Outcome:
    store = Store(job.results)
    state.log_hash = content_hash(path)
    state.robot = None if job.model is None else Robot.from_toml(job.model)
    state.path = store.path(job.operation, state.robot and state.robot.name, None, state.log_hash, job.key)
    if known := _known(store, job, state):
        return known
    began_s = time.perf_counter()
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        state.log = read_log(path, state.robot)
        state.robot = state.robot or state.log.robot
        if state.robot is None:
            raise LogError(f"{job.log.address} has no robot file attached; give the robot as `model`")
        state.path = store.path(job.operation, state.robot.name, _month(state.log), state.log_hash, job.key)
        if known := _known(store, job, state):
            return known
        rows = rows_of(job.operation, state.robot, state.log, job.options)
    texts = [str(warning.message) for warning in caught]
    common = _common(job, state, time.perf_counter() - began_s)
    store.write(state.path, [{**common, **row, "warnings": texts + row.get("warnings", [])} for row in rows])
    return Outcome(job.log, "computed", state.log_hash)


def _known(store: Store, job: Job, state: _State) -> Outcome | None:
    """Returns the outcome of the same work done before, on a log that now has another name or date; None if there is none."""
    path = state.path or ""
    if store.written(path):
        return Outcome(job.log, "known", state.log_hash)
    error = store.error_of(path)
    return None if error is None else Outcome(job.log, "failed", state.log_hash, error)


def _failed(job: Job, state: _State, error: Exception) -> Outcome:
    """Stores an error that is caused by the log itself beside the results."""
    text = str(error) or type(error).__name__
    # The worker's copy of a log has another name than the log.
    of_the_log = isinstance(error, _OF_THE_LOG) and not isinstance(error, (OSError, FleetError))
    if not isinstance(error, _OF_THE_LOG):
        text = f"{type(error).__name__}: {text}"
    outcome = Outcome(job.log, "failed", state.log_hash, text)
    if not of_the_log or state.path is None:
        return outcome
    try:
        Store(job.results).write(state.path, [{**_common(job, state, None), "error": text}], failed=True)
    except OSError as unwritten:
        return replace(outcome, error=f"{text} ({unwritten})")
    return outcome


def _common(job: Job, state: _State, seconds: float | None) -> dict[str, Any]:
    robot, log = state.robot, state.log
    dated = log is not None and _month(log) is not None
    return {
        "log": job.log.address,
        "log_hash": state.log_hash,
        "start": int(log.stamp_nanos[0]) if log is not None and dated else None,
        "duration_s": float(log.time_s[-1]) if log is not None and len(log) else None,
        "fric_version": __version__,
        "model_hash": robot and model_hash(robot.to_toml()),
        "options": json.dumps(dict(job.options), sort_keys=True, default=list),
        "seconds": seconds,
        "computed": datetime.now(timezone.utc),
    }


def model_hash(text: str) -> str:
    """Returns the SHA-256 of a robot file."""
    return hashlib.sha256(text.encode()).hexdigest()


def _month(log: Log) -> str | None:
    """Returns the year and month of the first sample of a log; None if its clock has no date."""
    if not len(log) or log.stamp_nanos[0] < _FIRST_DATE_NANOS:
        return None
    return str(np.datetime64(int(log.stamp_nanos[0]), "ns").astype("datetime64[M]"))


def _one_thread_a_task() -> None:
    """Lets fric use only as many threads as the worker runs tasks, unless its environment states otherwise."""
    try:
        thread_count = need("distributed").get_worker().state.nthreads
    except ValueError:
        # This process is not a worker.
        return
    os.environ.setdefault("RAYON_NUM_THREADS", str(thread_count))
