"""`run`: an operation over the logs of a fleet."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from itertools import islice
from typing import Any, Literal

from .._arguments import must_be
from .._errors import ConfigError
from .._fric import Robot, __version__
from .._progress import Bar
from .._results.base import Value, counted
from ._cluster import connected
from ._errors import FleetError
from ._logs import LogAddress, file_system, find
from ._needs import LIBRARIES, need
from ._operations import checked
from ._store import FAILED, Store, key_of
from ._task import Job, Outcome, model_hash, work

Path = str | os.PathLike[str]
# Number of tasks that wait for each thread. Thus the memory of the scheduler does not grow with the number of logs, and no thread is idle.
_TASKS_A_THREAD = 4


@dataclass(frozen=True, eq=False, repr=False)
class LogFailure(Value):
    """Log that gave no result."""

    log: str
    """Path or address of the log."""
    error: str
    """Sentence that states the problem."""


def told_once(failures: Sequence[LogFailure]) -> list[tuple[str, str]]:
    """Returns each error once, after the log that it concerns, or the first of them and the number of the others."""
    alike: dict[str, list[LogFailure]] = {}
    for failure in failures:
        # The errors of several logs may differ only in the names of these.
        alike.setdefault(failure.error.replace(f"`{failure.log}`", ""), []).append(failure)
    return [(first.log + (f" and {counted(len(more), 'more log')}" if more else ""), first.error) for first, *more in alike.values()]


@dataclass(frozen=True, eq=False, repr=False)
class FleetRun(Value):
    """Result of `run`. `print(run)` states what was done, with every error."""

    operation: str
    """"discover", "fit" or "replay"."""
    results: str
    """Path or address of the data set."""
    logs: int
    """Number of logs that the paths name."""
    computed: int
    """Number of logs that were computed."""
    known: int
    """Number of logs whose results existed and were not computed again."""
    failures: tuple[LogFailure, ...]
    """Logs without a result, from this run or from an earlier one that gave the same error."""

    def summary(self) -> str:
        """Returns the counts, and one line for every error with the logs that it concerns."""
        head = f"{self.operation} of {counted(self.logs, 'log')} into {self.results}: {self.computed} computed, {self.known} there before"
        lines = [f"{head}, {len(self.failures)} failed"] + [f"  {logs}: {error}" for logs, error in told_once(self.failures)]
        return "\n".join(lines) + "\n"

    def __str__(self) -> str:
        return self.summary()


def run(
    operation: Literal["discover", "fit", "replay"],
    paths: Path | Sequence[Path],
    *,
    results: Path,
    model: Robot | Path | None = None,
    client: Any = None,
    workers: int | None = None,
    progress: bool | Callable[[float], object] | None = False,
    **options: Any,
) -> FleetRun:
    """Runs `fric.fit`, `fric.discover` or `fric.replay` over many logs, one task each, and keeps the results.

    `paths` are paths, globs, and fsspec addresses ("s3://bucket/2026/**/*.mcap"). A log that is not on this machine is fetched by the worker into a
    temporary file. `results` is a folder or an address that all workers can write to: a Parquet data set with one row per log, cable, and parameter.
    `model` is the robot of all logs, as an object, path, or address; without it, each log must have its own attached. `options` are those of the
    operation: `reference`, `parameters`, and `huber` of a fit, `reference` and `empirical` of a discovery, `correct` of a replay.

    `client` is a `distributed.Client` or a scheduler's address. Without it, `workers` processes of this machine are started (by default as many as it
    has cores) and ended. A script then needs `if __name__ == "__main__":`, as with every process pool. Workers of a scheduler need fric and the
    libraries of fleets installed, and preferably one thread each (`dask worker --nthreads 1`).

    The result of a log depends on its bytes, the model, the options, and the version of fric. A log for which such a result exists is not computed
    again. Hence the same call continues a run that was interrupted, and adds new logs. A worker that dies is replaced, and its log is processed by
    another. An error stays with its log and is listed in `failures`. If its cause lies in the bytes of the log, it is kept as the result of the log;
    the logs of all other errors are tried again by the next run.

    `progress` is True for a bar, or a function that is called with 0 … 1.

    Raises ConfigError if the operation, an option, or the model is invalid, LogFileNotFoundError if a path matches nothing, FleetError if no
    scheduler or worker answers, and ImportError if a library of the extra `fleet` is missing.
    """
    path = (str, os.PathLike)
    must_be("operation", operation, "a text", str)
    must_be("results", results, "a path or an address", *path)
    must_be("model", model, "a Robot, a path or None", Robot, *path, type(None))
    must_be("workers", workers, "a whole number or None", int, type(None))
    checked(operation, options)
    text = _text_of(model)
    key = key_of(__version__, operation, options, None if text is None else model_hash(text))
    store = Store(_absolute(results))
    logs = find(paths, store.address)
    there, seen = store.names(), store.seen()
    missing, earlier = _missing(logs, seen, there, key)
    states = {"computed": 0, "known": len(logs) - len(missing)}
    failures = [_renamed(address, *store.error_at(path)) for address, path in earlier]
    states["known"] -= len(failures)
    show = Bar() if progress is True else progress or _nothing
    show(1.0 if not missing else 1 - len(missing) / len(logs))
    jobs = (Job(operation, log, text, options, store.address, key, __version__) for log in missing)
    try:
        if missing:
            with connected(client, workers) as at:
                for place, outcome in enumerate(_outcomes(at, jobs), start=1):
                    _note(outcome, store, states, failures)
                    show(1 - (len(missing) - place) / len(logs))
    finally:
        store.flush()
    ordered = tuple(sorted(failures, key=lambda failure: failure.log))
    return FleetRun(operation, store.address, len(logs), states["computed"], states["known"], ordered)


def _note(outcome: Outcome, store: Store, states: dict[str, int], failures: list[LogFailure]) -> None:
    if outcome.state == "wrong_call":
        raise ConfigError(outcome.error)
    if outcome.log_hash is not None:
        store.remember(outcome.log, outcome.log_hash)
    if outcome.error is not None:
        failures.append(LogFailure(outcome.log.address, outcome.error))
    else:
        states[outcome.state] += 1


def _renamed(address: str, log: str, error: str) -> LogFailure:
    """Returns the error that was stored for a log which now has another address."""
    return LogFailure(address, error.replace(f"`{log}`", f"`{address}`"))


def _missing(
    logs: list[LogAddress], seen: dict[str, str], there: dict[str, str], key: str
) -> tuple[list[LogAddress], list[tuple[str, str]]]:
    """Returns the logs without a result, and address and path of the error of those that failed before."""
    missing, failed = [], []
    for log in logs:
        name = f"{seen.get(log.stamp)}-{key}"
        if name + FAILED in there:
            failed.append((log.address, there[name + FAILED]))
        elif name not in there:
            missing.append(log)
    return missing, failed


def _outcomes(client: Any, jobs: Iterator[Job]) -> Iterator[Outcome]:
    """Yields the outcomes of all jobs as they arrive, with a bounded number of jobs at the scheduler."""
    distributed = need("distributed")
    waiting: dict[Any, Job] = {}

    def next_ones(count: int) -> list[Any]:
        new = {
            client.submit(work, job, key=f"fric-{job.operation}-{job.log.stamp}-{job.key}", pure=False): job
            for job in islice(jobs, count)
        }
        waiting.update(new)
        return list(new)

    pool = distributed.as_completed(next_ones(_TASKS_A_THREAD * _threads(client)))
    try:
        for future in pool:
            job = waiting.pop(future)
            yield _outcome(distributed, future, job)
            # The number of workers may change during the run.
            for new in next_ones(max(0, _TASKS_A_THREAD * _threads(client) - len(waiting))):
                pool.add(new)
    finally:
        client.cancel(list(waiting), force=True)


def _outcome(distributed: Any, future: Any, job: Job) -> Outcome:
    try:
        outcome: Outcome = future.result()
    except distributed.KilledWorker as error:
        times = error.allowed_failures + 1
        text = f"{times} workers died over it; it may need more memory than they have (it is tried again by the next run)"
        return Outcome(job.log, "failed", error=text)
    except Exception as error:
        raise FleetError(
            f"a worker cannot run fric: {type(error).__name__}: {error}; install fric there in the same version, and `pip install {LIBRARIES}`"
        ) from error
    return outcome


def _threads(client: Any) -> int:
    return max(1, sum(int(count) for count in client.nthreads().values()))


def _text_of(model: Robot | Path | None) -> str | None:
    """Returns the text of the robot file, validated; None if each log has its own."""
    if model is None or isinstance(model, Robot):
        return model and model.to_toml()
    fs, path = file_system(os.fspath(model))
    if fs.protocol == "file" or "file" in fs.protocol:
        return Robot.read(path).to_toml()
    try:
        return Robot.from_toml(fs.cat_file(path).decode()).to_toml()
    except FileNotFoundError as error:
        raise ConfigError(f"there is no robot file at {os.fspath(model)}") from error


def _absolute(results: Path) -> str:
    """Returns a path that is also valid for workers in other folders."""
    address = os.fspath(results)
    return address if "://" in address or "::" in address else os.path.abspath(os.path.expanduser(address))


def _nothing(fraction: float) -> None:
    """Shows no progress."""
