"""`trend`: what has changed on a fleet, since when, and what to do about it."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from datetime import datetime, timedelta, timezone
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from .._arguments import must_be
from .._errors import ConfigError
from .._fric import _unknown_name
from .._results.base import Result, Shown, Value
from ._changes import Change as Found
from ._changes import Course, course
from ._run import LogFailure
from ._series import Gathered, Values, gather

Limits = Mapping[str, tuple[float | None, float | None]]

YEAR_NANOS = 365.25 * 86_400e9
# Rate of false alarms for last values: one in a hundred evaluations of a whole fleet.
_FALSE_ALARMS = 0.01


@dataclass(frozen=True, eq=False, repr=False)
class Change(Value):
    """Date from which a parameter has another value or another slope."""

    parameter: str
    """Name of the parameter."""
    kind: Literal["step", "slope"]
    """ "step": something was replaced, adjusted, or has broken; "slope": something begins to dry, wear, or drift."""
    date: datetime
    """Start of the first log after the step, or of the log from which the slope begins, UTC."""
    earliest: datetime
    """Start of the first log of the 95 % interval."""
    latest: datetime
    """Start of the last log of the 95 % interval."""
    log: str
    """Log of `date`."""
    before: float
    """Value before the step, or at the start of the slope."""
    after: float
    """Value after the step, or at the end of the slope."""
    size: float
    """Size of the step, or change of the slope per year."""
    size_standard_error: float
    """Standard error of the size."""
    delta_bic: float
    """Evidence: negative values favour the change, and -10 does very strongly. It accounts for the odds of finding a change by chance among all logs
    and series."""
    of_model: bool
    """Whether model or options of the logs change within the interval too, which may be the reason; such a change is no alarm."""


@dataclass(frozen=True, eq=False, repr=False)
class NamedEffect(Value):
    """Effect that the discovery of some logs has named, or that of all."""

    robot: str
    """Name of the robot."""
    cable: str
    """Name of the cable."""
    kind: str
    """Name of the effect."""
    logs: int
    """Number of logs in which it is named."""
    of_logs: int
    """Number of logs of the robot."""
    first: datetime
    """Start of the first log in which it is named, UTC."""


@dataclass(frozen=True, eq=False, repr=False)
class Series(Value):
    """Parameter of a cable over the dates of the logs, (N,)."""

    robot: str
    """Name of the robot, from its model."""
    cable: str
    """Name of the cable, or "platform" for parameters of all cables."""
    parameter: str
    """Name of the parameter, by the keys of the robot file, or of an error such as "after.rms_n"."""
    date: NDArray[np.datetime64]
    """Start of each log, UTC."""
    values: NDArray[np.float64]
    """Values of the parameter."""
    standard_errors: NDArray[np.float64]
    """Standard errors of the values; NaN if the operation gives none."""
    fitted: NDArray[np.float64]
    """Line that describes the values: levels, steps, and slopes."""
    scatter: float
    """Standard deviation from log to log in addition to the standard errors."""
    wanders: bool
    """Whether the values wander, which no date of a change explains."""
    changes: tuple[Change, ...]
    """Changes in order of date."""
    limits: tuple[float | None, float | None]
    """Least and greatest allowed value; None where there is no limit."""


@dataclass(frozen=True, eq=False, repr=False)
class Alarm(Value):
    """Condition of a machine that requires action."""

    robot: str
    """Name of the robot."""
    cable: str
    """Name of the cable."""
    reason: Literal["history", "limit", "last_log"]
    """ "history": changed relative to the past; "limit": beyond a given limit, also by such a change; "last_log": only the last log is an outlier."""
    date: datetime
    """Date from which the alarm holds, UTC."""
    parameters: tuple[str, ...]
    """Parameters that show it, strongest evidence first."""
    changes: tuple[Change, ...]
    """Changes of these parameters; empty if the alarm is of none."""
    text: str
    """Sentence that states what happened."""
    cause: str
    """Likely cause."""
    remedy: str
    """Action on the machine."""


@dataclass(frozen=True, eq=False, repr=False)
class Trend(Result):
    """Result of `trend`. `print(trend)` shows the alarms; `to_html()` is a page for people."""

    operation: str
    """Operation that gave the results."""
    logs: int
    """Number of logs with a result and a date."""
    series: tuple[Series, ...]
    """All series, by robot, cable, and parameter."""
    alarms: tuple[Alarm, ...]
    """Required actions, latest first."""
    failures: tuple[LogFailure, ...]
    """Logs without a result, with the reason."""
    undated: tuple[str, ...]
    """Logs that are excluded because their clock has no date."""
    named: tuple[NamedEffect, ...]
    """Effects that a discovery has named, by robot, cable, and kind. They are no series."""

    def of(self, robot: str, cable: str, parameter: str) -> Series:
        """Returns the series of a robot, cable, and parameter."""
        chosen = self.series
        for what, name in (("robot", robot), ("cable", cable), ("parameter", parameter)):
            must_be(what, name, "a text", str)
            known = list(dict.fromkeys(getattr(one, what) for one in chosen))
            chosen = tuple(one for one in chosen if getattr(one, what) == name)
            if not chosen:
                raise ConfigError(_unknown_name(what, name, known))
        return chosen[0]


def trend(results: Any, *, operation: Literal["discover", "fit", "replay"] | None = None, limits: Limits | None = None) -> Trend:
    """Determines what has changed on each robot and cable, in which parameter, and since when.

    `results` is what `run` returned, the address of its data set, or a table with the columns robot, cable, parameter, start, and value, and
    optionally standard_error (a `pyarrow.Table`, or a data frame of pandas or polars). `operation` selects the results if the data set has those of
    several operations. `limits` are least and greatest allowed values, None for none, by parameter (`{"mu": (None, 0.05)}`) or by robot, cable, and
    parameter (`{"rig/cable1/mu": (None, 0.04)}`).

    A change is a step or the start of a slope. It is reported if there is evidence for it after accounting for the standard errors, the scatter from
    log to log, outliers, a slow wander, and the number of dates and series among which it was found. At least three logs must lie on each side of it.
    If a log was computed more than once, the last result counts. A change that falls on one of the model or of the options is told, but is no alarm.

    Raises ConfigError if there are no results or a name is invalid, and ShapeError for a table without these columns.
    """
    must_be("operation", operation, "a text or None", str, type(None))
    gathered = gather(results, operation)
    bounds = _checked({} if limits is None else limits, gathered.series)
    courses = [_course(one, len(gathered.series)) for one in gathered.series]
    series = tuple(_series(one, found, bounds) for one, found in zip(gathered.series, courses))
    return _assembled(gathered, series, courses)


def _course(values: Values, series_count: int) -> Course:
    years = (values.stamp_nanos - values.stamp_nanos[0]) / YEAR_NANOS
    return course(years, values.value, values.standard_error, series_count)


def _series(values: Values, found: Course, bounds: dict[str, tuple[float | None, float | None]]) -> Series:
    changes = tuple(_change(values, found, place, one) for place, one in enumerate(found.changes))
    name = f"{values.robot}/{values.cable}/{values.parameter}"
    limit = bounds.get(name, bounds.get(values.parameter, (None, None)))
    dates = values.stamp_nanos.astype("datetime64[ns]")
    return Series(
        values.robot,
        values.cable,
        values.parameter,
        dates,
        values.value,
        values.standard_error,
        found.fitted,
        found.scatter,
        found.wanders,
        changes,
        limit,
    )


def _change(values: Values, found: Course, place: int, change: Found) -> Change:
    begin = change.log_index
    end = next((one.log_index for one in found.changes[place + 1 :]), len(values.value)) - 1
    is_step = change.kind != "slope"
    column = found.line.column(place)
    return Change(
        values.parameter,
        "step" if is_step else "slope",
        _date(values.stamp_nanos[begin]),
        _date(values.stamp_nanos[change.earliest]),
        _date(values.stamp_nanos[change.latest]),
        values.logs[begin],
        float(found.fitted[begin - 1 if is_step else begin]),
        float(found.fitted[begin if is_step else end]),
        float(found.coefficients[column]),
        float(np.sqrt(found.covariance[column, column])),
        change.delta_bic,
        len(set(values.models[max(change.earliest - 1, 0) : change.latest + 1])) > 1,
    )


def _assembled(gathered: Gathered, series: tuple[Series, ...], courses: list[Course]) -> Trend:
    from ._alarms import alarms_of
    from ._page import page
    from ._words import json_of, summary_of, table_of

    last_limit = _beyond_by_chance(_FALSE_ALARMS / max(1, len(series)))
    alarms = alarms_of(series, [abs(one.last_t) > last_limit for one in courses])
    named = tuple(NamedEffect(one.robot, one.cable, one.kind, one.logs, one.of_logs, _date(one.first_nanos)) for one in gathered.found)

    def with_texts(shown: Shown) -> Trend:
        return Trend(shown, gathered.operation, gathered.logs, series, alarms, gathered.failures, gathered.undated, named)

    bare = with_texts(Shown("", "", "", ""))
    return with_texts(Shown(summary_of(bare), json_of(bare), page(bare), table_of(bare)))


def _checked(limits: Limits, series: tuple[Values, ...]) -> dict[str, tuple[float | None, float | None]]:
    known = {one.parameter for one in series} | {f"{one.robot}/{one.cable}/{one.parameter}" for one in series}
    must_be("limits", limits, 'a dict of pairs, such as {"mu": (None, 0.05)}', Mapping)
    for name, bounds in limits.items():
        # Without a series nothing is known, and the remark on the logs says why.
        if series and name not in known:
            raise ConfigError(_unknown_name("parameter for a limit", str(name), sorted({one.parameter for one in series})))
        pair = tuple(bounds) if isinstance(bounds, (list, tuple, np.ndarray)) else ()
        if len(pair) != 2 or not all(one is None or (isinstance(one, (int, float)) and math.isfinite(one)) for one in pair):
            raise ConfigError(f"the limit of `{name}` in `limits` is {bounds}; give least and greatest value as a pair, None for none")
        if pair[0] is not None and pair[1] is not None and pair[0] >= pair[1]:
            raise ConfigError(f"the limit of `{name}` in `limits` is {bounds}; the least value comes first")
    return {name: (bounds[0], bounds[1]) for name, bounds in limits.items()}


def _date(stamp_nanos: Any) -> datetime:
    return datetime(1970, 1, 1, tzinfo=timezone.utc) + timedelta(microseconds=int(stamp_nanos) // 1000)


def _beyond_by_chance(probability: float) -> float:
    """Returns the quantile of Student's t with 4 degrees of freedom that is exceeded, on both sides together, with a given probability (Shaw
    2006)."""
    upper = 1 - probability / 2
    product = math.sqrt(4 * upper * (1 - upper))
    return 2 * math.sqrt(math.cos(math.acos(product) / 3) / product - 1)
