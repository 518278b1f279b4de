"""Operations that can be run over a fleet, and the rows that each one gives."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterator, Mapping
from typing import Any, NamedTuple

from .._errors import ConfigError
from .._fric import Log, Robot, _unknown_name, discover, fit, replay
from .._results import DiscoverResult, FitResult, ForceError, ReplayResult, WrenchError

Rows = Iterator[dict[str, Any]]


class Operation(NamedTuple):
    """Function of fric that takes a robot and a log."""

    call: Callable[..., Any]
    options: tuple[str, ...]
    rows: Callable[[Any], Rows]


def checked(operation: str, options: Mapping[str, Any]) -> Operation:
    """Returns the operation of a name. Raises ConfigError if there is none, or if it lacks one of the options."""
    if operation not in OPERATIONS:
        raise ConfigError(_unknown_name("operation", operation, list(OPERATIONS)))
    found = OPERATIONS[operation]
    for option in options:
        if option not in found.options:
            raise ConfigError(_unknown_name(f"option of {operation}", option, list(found.options)))
    return found


def rows_of(operation: str, robot: Robot, log: Log, options: Mapping[str, Any]) -> list[dict[str, Any]]:
    """Runs an operation on a log and returns cable, parameter, value, standard_error, state, and verdict of every row."""
    found = OPERATIONS[operation]
    return list(found.rows(found.call(robot, log, **options)))


def _row(cable: str | None, parameter: str, value: float | None, **rest: Any) -> dict[str, Any]:
    return {"cable": cable, "parameter": parameter, "value": value, **rest}


def _of_fit(result: FitResult) -> Rows:
    for cable in result.cables:
        for parameter, value in cable.values.items():
            error = cable.standard_errors.get(parameter)
            state = "at_bound" if parameter in cable.at_bound else "kept" if error is None else "fitted"
            yield _row(cable.name, parameter, value, standard_error=error, state=state)
        yield from _force_errors(cable.name, cable.before, cable.after)
    yield from _wrench_errors(result.wrench)


def _of_discovery(result: DiscoverResult) -> Rows:
    for cable in result.cables:
        verdict = cable.verdict
        for parameter, value in cable.parameters.items():
            error = cable.standard_errors.get(parameter)
            state = "kept" if error is None else "fitted"
            yield _row(cable.name, parameter, value, standard_error=error, state=state, verdict=verdict)
        # A row a kind: how many of it were found.
        for kind, count in Counter(effect["kind"] for effect in cable.effects).items():
            yield _row(cable.name, f"found.{kind}", float(count), state="found", verdict=verdict)
        if cable.noise_floor_n is not None:
            yield _row(cable.name, "noise_floor_n", cable.noise_floor_n, state="measured", verdict=verdict)
        for row in _force_errors(cable.name, cable.before, cable.after):
            yield {**row, "verdict": verdict}
        if cable.missing is not None:
            yield _row(cable.name, "verdict", None, state="missing", warnings=[f"{cable.missing['cause']}; {cable.missing['advice']}"])


def _of_replay(result: ReplayResult) -> Rows:
    for cable in result.cables:
        if cable.samples:
            yield _row(cable.name, "flagged_ratio", cable.flagged / cable.samples, state="measured")
        yield from _force_errors(cable.name, cable.before, cable.after)
    yield from _wrench_errors(result.wrench)


def _force_errors(cable: str, before: ForceError | None, after: ForceError | None) -> Rows:
    for when, error in (("before", before), ("after", after)):
        if error is not None:
            yield _row(cable, f"{when}.rms_n", error.rms_n, state="measured")
            yield _row(cable, f"{when}.mae_n", error.mae_n, state="measured")


def _wrench_errors(errors: tuple[WrenchError, WrenchError] | None) -> Rows:
    for when, error in zip(("before", "after"), errors or ()):
        yield _row(None, f"{when}.force_rms_n", error.force_rms_n, state="measured")
        yield _row(None, f"{when}.torque_rms_nm", error.torque_rms_nm, state="measured")


OPERATIONS = {
    "discover": Operation(discover, ("reference", "empirical"), _of_discovery),
    "fit": Operation(fit, ("reference", "parameters", "huber"), _of_fit),
    "replay": Operation(replay, ("correct",), _of_replay),
}
"""Operations that `run` accepts."""
