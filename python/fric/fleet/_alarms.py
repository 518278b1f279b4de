"""Alarms: changes that belong together, exceeded limits, and a last log that is an outlier."""

from __future__ import annotations

from dataclasses import replace
from datetime import datetime, timedelta, timezone
from itertools import groupby

import numpy as np

from ._advice import advice
from ._trend import YEAR_NANOS, Alarm, Change, Series


def alarms_of(series: tuple[Series, ...], out_of_line: list[bool]) -> tuple[Alarm, ...]:
    """Returns all alarms, latest first."""
    alarms = []
    for (robot, cable), group in groupby(series, key=lambda one: (one.robot, one.cable)):
        alarms += [_of_history(robot, cable, changes) for changes in _together(tuple(group))]
    for one, is_out in zip(series, out_of_line):
        limit = _of_limit(one)
        if limit is not None:
            _add_limit(alarms, limit)
        elif is_out:
            alarms.append(_of_last_log(one))
    return tuple(sorted(alarms, key=lambda alarm: alarm.date, reverse=True))


def _add_limit(alarms: list[Alarm], limit: Alarm) -> None:
    """Adds an exceeded limit: to the alarm of the change that exceeds it, if there is one from the same date."""
    [parameter] = limit.parameters
    for place, alarm in enumerate(alarms):
        is_of_machine = (alarm.robot, alarm.cable) == (limit.robot, limit.cable)
        if is_of_machine and any((one.parameter, one.date) == (parameter, limit.date) for one in alarm.changes):
            alarms[place] = replace(alarm, reason="limit", text=f"{alarm.text}; {limit.text}")
            return
    alarms.append(limit)


def day(date: datetime) -> str:
    """Returns a date as text for people."""
    return date.strftime("%Y-%m-%d")


def _together(series: tuple[Series, ...]) -> list[list[tuple[Series, Change]]]:
    """Groups the changes of a cable that have one cause, strongest first.

    Changes belong together if they may have the same date. Slopes also do if one begins while the other continues, because a parameter that the model
    lacks bends the other parameters. A change of the residual error follows from a parameter that has changed before.
    """
    changes = [(one, change) for one in series for change in one.changes if not change.of_model]
    parameters = [pair for pair in changes if not _follows(pair[1])]
    groups: list[list[tuple[Series, Change]]] = []
    for pair in sorted(parameters, key=lambda pair: pair[1].delta_bic):
        for group in groups:
            if _of_one_date(group[0][1], pair[1]) or _go_on_together(group[0], pair):
                group.append(pair)
                break
        else:
            groups.append([pair])
    for pair in sorted((pair for pair in changes if _follows(pair[1])), key=lambda pair: pair[1].delta_bic):
        causes = [group for group in groups if group[0][1].earliest <= pair[1].latest]
        if causes:
            max(causes, key=lambda group: group[0][1].date).append(pair)
        else:
            groups.append([pair])
    return groups


def _of_one_date(one: Change, other: Change) -> bool:
    return one.earliest <= other.latest and other.earliest <= one.latest


def _go_on_together(one: tuple[Series, Change], other: tuple[Series, Change]) -> bool:
    """Returns whether two slopes overlap in time."""
    if one[1].kind != "slope" or other[1].kind != "slope":
        return False
    return one[1].date < _end(other) and other[1].date < _end(one)


def _end(pair: tuple[Series, Change]) -> datetime:
    """Returns the date at which a slope ends: that of the next slope, or of the last log."""
    series, change = pair
    later = [one.date for one in series.changes if one.date > change.date]
    return min(later, default=_date_of(series, -1))


def _follows(change: Change) -> bool:
    return change.parameter.startswith(("before.", "after."))


def _of_history(robot: str, cable: str, pairs: list[tuple[Series, Change]]) -> Alarm:
    changes = tuple(change for _, change in pairs)
    first = changes[0]
    told = advice(first.parameter, first.kind, rises=first.size > 0)
    text = "; ".join([_sentence(pairs[0]), *(_short(pair[1]) for pair in pairs[1:])])
    parameters = tuple(dict.fromkeys(change.parameter for change in changes))
    return Alarm(robot, cable, "history", first.date, parameters, changes, text, told.cause, told.remedy)


def _sentence(pair: tuple[Series, Change]) -> str:
    series, change = pair
    if change.kind == "step":
        return f"{change.parameter} steps from {change.before:.4g} to {change.after:.4g}"
    way = "rises" if change.after >= change.before else "falls"
    begin = "since before the first log" if change.date == _first(series) else f"from {change.before:.4g} on"
    return f"{change.parameter} {way} {begin}, to {change.after:.4g}{_reaches(series)}"


def _short(change: Change) -> str:
    word = "steps" if change.kind == "step" else "rises" if change.after >= change.before else "falls"
    return f"{change.parameter} {word} to {change.after:.4g}"


def _first(series: Series) -> datetime:
    return _date_of(series, 0)


def _reaches(series: Series) -> str:
    """Returns when the line, if it continues, reaches a limit."""
    if len(series.fitted) < 2 or series.date[-1] == series.date[-2]:
        return ""
    pace = (series.fitted[-1] - series.fitted[-2]) / float((series.date[-1] - series.date[-2]).astype(np.int64))
    bound = series.limits[1] if pace > 0 else series.limits[0]
    if pace == 0 or bound is None or (bound - series.fitted[-1]) / pace <= 0:
        return ""
    years = (bound - series.fitted[-1]) / pace / YEAR_NANOS
    # An extrapolation further ahead than the logs reach back is meaningless.
    if years > float((series.date[-1] - series.date[0]).astype(np.int64)) / YEAR_NANOS:
        return ""
    return f"; at this pace it reaches {bound:.4g} about {day(_date_of(series, -1) + timedelta(days=365.25 * years))}"


def _of_limit(series: Series) -> Alarm | None:
    least, greatest = series.limits
    for bound, side, is_beyond in ((least, "below", np.less), (greatest, "above", np.greater)):
        if bound is None or not is_beyond(series.fitted[-1], bound):
            continue
        inside = np.flatnonzero(~is_beyond(series.fitted, bound))
        since = int(inside[-1]) + 1 if inside.size else 0
        told = advice(series.parameter, "slope", rises=side == "above")
        text = f"{series.parameter} is {series.fitted[-1]:.4g}, {side} the limit of {bound:.4g}"
        return Alarm(series.robot, series.cable, "limit", _date_of(series, since), (series.parameter,), (), text, told.cause, told.remedy)
    return None


def _of_last_log(series: Series) -> Alarm:
    text = f"{series.parameter} of the last log is {series.values[-1]:.4g}, where {series.fitted[-1]:.4g} is expected"
    cause = "the log went wrong, or something has just changed"
    remedy = "record another log; three that agree tell"
    return Alarm(series.robot, series.cable, "last_log", _date_of(series, -1), (series.parameter,), (), text, cause, remedy)


def _date_of(series: Series, place: int) -> datetime:
    stamp_nanos = int(series.date[place].astype(np.int64))
    return datetime(1970, 1, 1, tzinfo=timezone.utc) + timedelta(microseconds=stamp_nanos // 1000)
