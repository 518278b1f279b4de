"""Trend as text, JSON, and table."""

from __future__ import annotations

import json
import math
from datetime import datetime, timezone
from html import escape
from typing import Any

from .._fric import __version__
from .._results.base import counted
from ._alarms import day
from ._joints import LEAST_LOGS
from ._run import told_once
from ._trend import Alarm, Change, NamedEffect, Series, Trend

FORMAT = "fric-trend/1"
TOO_FEW = f"too few logs of different dates, {2 * LEAST_LOGS} of each robot are needed"


def between(change: Change) -> str:
    """Returns the date of a change with the precision that the logs allow."""
    if change.earliest == change.latest:
        return day(change.date)
    return f"{day(change.date)} ({day(change.earliest)} to {day(change.latest)})"


def since(alarm: Alarm) -> str:
    """Returns the date from which an alarm holds."""
    return between(alarm.changes[0]) if alarm.changes else day(alarm.date)


def headline(trend: Trend) -> str:
    """Returns a sentence that states what was examined."""
    robots = len({one.robot for one in trend.series})
    examined = f"{counted(trend.logs, 'log')} of {counted(robots, 'robot')}, {len(trend.series)} series by fric {trend.operation}"
    if trend.alarms:
        return f"{examined}: {counted(len(trend.alarms), 'alarm')}"
    return f"{examined}: {'nothing has changed' + _but(trend) if may_show_a_change(trend) else TOO_FEW}"


def _but(trend: Trend) -> str:
    """Returns what is no alarm and yet no sameness, the end of a sentence; empty if there is nothing of it."""
    parts = ["values that go with another model"] * bool(_of_model(trend))
    parts += ["effects that only some logs show"] * bool(_at_times(trend))
    return f" but {' and '.join(parts)}" if parts else ""


def _of_model(trend: Trend) -> list[tuple[Series, Change]]:
    """Returns the changes that fall on one of the model or of the options."""
    return [(one, change) for one in trend.series for change in one.changes if change.of_model]


def _at_times(trend: Trend) -> list[NamedEffect]:
    """Returns the effects that are named in some logs only."""
    return [one for one in trend.named if one.logs < one.of_logs]


def may_show_a_change(trend: Trend) -> bool:
    """Whether every robot has as many logs as a change needs."""
    shows: dict[str, bool] = {}
    for one in trend.series:
        shows[one.robot] = shows.get(one.robot, False) or has_course(one)
    return bool(shows) and all(shows.values())


def has_course(series: Series) -> bool:
    """Whether a series has as many logs as a change needs, and more than one date."""
    return len(series.values) >= 2 * LEAST_LOGS and bool(series.date[0] < series.date[-1])


def verdict(trend: Trend) -> str:
    """Returns the result in a sentence for people who do not run the robots."""
    robots = list(dict.fromkeys(one.robot for one in trend.series))
    fleet = f"{len(robots)} robots" if len(robots) != 1 else "the robot"
    if not trend.alarms and not may_show_a_change(trend):
        return f"This cannot tell whether anything has changed: {TOO_FEW}."
    if not trend.alarms:
        return f"Nothing has changed on {fleet}{_but(trend)}."
    places = list(dict.fromkeys(f"{one.robot} {one.cable}" for one in trend.alarms))
    named = ", ".join(places[:3]) + (f" and {len(places) - 3} more" if len(places) > 3 else "")
    return f"Something is to be done at {counted(len(places), 'place')} of {fleet}: {named}."


def provenance() -> dict[str, Any]:
    """Returns program, version, date, and command, as in the other results."""
    made = datetime.now(timezone.utc).strftime("%Y-%m-%dT%H:%M:%SZ")
    return {"program": "fric", "version": __version__, "made": made, "command": "fric.fleet.trend", "inputs": []}


def remarks(trend: Trend) -> list[str]:
    """Returns remarks on logs that are excluded and on series that wander."""
    texts = []
    if trend.undated:
        have = "log has no date and is left out: its" if len(trend.undated) == 1 else "logs have no date and are left out: their"
        texts.append(f"{len(trend.undated)} {have} clock begins at 0 (such as {trend.undated[0]})")
    if wandering := [one for one in trend.series if one.wanders]:
        names = ", ".join(f"{one.robot} {one.cable} {one.parameter}" for one in wandering[:3])
        wander = "wanders, with no date at which it begins to" if len(wandering) == 1 else "wander, with no date at which they begin to"
        texts.append(f"{len(wandering)} series {wander}: {names}{' …' if len(wandering) > 3 else ''}")
    if of_model := _of_model(trend):
        names = ", ".join(f"{one.robot} {one.cable} {one.parameter} on {day(change.date)}" for one, change in of_model[:3])
        changes = "1 change falls" if len(of_model) == 1 else f"{len(of_model)} changes fall"
        rest = " …" if len(of_model) > 3 else ""
        texts.append(f"{changes} on another model or other options and is no alarm ({names}{rest}); run all logs with the same ones")
    for one in _at_times(trend):
        texts.append(f"{one.kind} is named on {one.robot} {one.cable} in {one.logs} of {one.of_logs} logs, first on {day(one.first)}")
    if trend.failures:
        texts.append(f"{counted(len(trend.failures), 'log')} gave no result")
    return texts


def summary_of(trend: Trend) -> str:
    """Returns the text of `print(trend)`."""
    lines = [headline(trend)]
    for alarm in trend.alarms:
        lines += ["", f"{alarm.robot}, {alarm.cable}, since {since(alarm)}: {alarm.text}"]
        lines += [f"  likely: {alarm.cause}", f"  to do:  {alarm.remedy}"]
    notes = remarks(trend)
    lines += [""] * bool(notes) + notes + [f"  {logs}: {error}" for logs, error in told_once(trend.failures)]
    return "\n".join(lines) + "\n"


def json_of(trend: Trend) -> str:
    """Returns the trend as JSON."""
    found = {
        "format": FORMAT,
        "operation": trend.operation,
        "logs": trend.logs,
        "alarms": [{**_plain(vars(alarm)), "changes": [_plain(vars(change)) for change in alarm.changes]} for alarm in trend.alarms],
        "series": [_series(one) for one in trend.series],
        "failures": [vars(one) for one in trend.failures],
        "undated": trend.undated,
        "named": [_plain(vars(one)) for one in trend.named],
        "provenance": provenance(),
    }
    return json.dumps(found, indent=2, ensure_ascii=False, allow_nan=False) + "\n"


def table_of(trend: Trend) -> str:
    """Returns the table for a notebook."""
    head = "".join(f"<th>{name}</th>" for name in ("robot", "cable", "since", "what", "to do"))
    rows = "".join(
        "<tr>" + "".join(f"<td>{escape(text)}</td>" for text in (one.robot, one.cable, since(one), one.text, one.remedy)) + "</tr>"
        for one in trend.alarms
    )
    return f"<p>{escape(headline(trend))}</p><table><thead><tr>{head}</tr></thead><tbody>{rows}</tbody></table>"


def _series(series: Series) -> dict[str, Any]:
    found = {key: value for key, value in vars(series).items() if key not in ("date", "changes")}
    dates = [f"{date}Z" for date in series.date.astype("datetime64[ms]").astype(str)]
    return {**_plain(found), "date": dates, "changes": [_plain(vars(change)) for change in series.changes]}


def _plain(values: dict[str, Any]) -> dict[str, Any]:
    return {key: _value(value) for key, value in values.items() if key != "changes"}


def _value(value: Any) -> Any:
    if isinstance(value, datetime):
        return value.isoformat()
    if hasattr(value, "tolist"):
        return [_value(one) for one in value.tolist()]
    return None if isinstance(value, float) and not math.isfinite(value) else value
