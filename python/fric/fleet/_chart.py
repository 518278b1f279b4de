"""Drawing of a series in a page."""

from __future__ import annotations

from datetime import datetime
from html import escape

import numpy as np

from ._alarms import day
from ._noise import Array
from ._trend import Alarm, Change, Series

# Letters stay readable if the drawing is as wide as the screen of a telephone.
_WIDTH, _HEIGHT = 460.0, 210.0
_LEFT, _RIGHT, _TOP, _BOTTOM = 62.0, 10.0, 14.0, 26.0
# Two-sided 95 % quantile of the normal distribution.
_SIGMAS = 1.96
# Greatest number of ticks of an axis.
_TICKS = 5
# Between ticks of dates: days, or months.
_DAYS = (1, 2, 5, 10, 20)
_MONTHS = (1, 2, 3, 6, 12, 24, 60, 120)


def legend(series: Series, alarm: Alarm) -> dict[str, str]:
    """Returns what the marks of a chart mean, by their classes."""
    own, others = _changes(series, alarm)
    told = {"value": "values of the logs, with 95 % intervals", "fitted": "line that describes them"}
    told |= {"since": f"since {day(own[0].date if own else alarm.date)}"}
    if any(one.earliest < one.latest for one in own):
        told |= {"when": "where that date may be, 95 %"}
    if others:
        told |= {"bend": "another change of the line"}
    if any(bound is not None for bound in series.limits):
        told |= {"limit": "limit"}
    return told


def _changes(series: Series, alarm: Alarm) -> tuple[list[Change], list[Change]]:
    """Returns the changes of a series that belong to an alarm, and the others."""
    dates = {one.date for one in alarm.changes if one.parameter == series.parameter}
    own = [one for one in series.changes if one.date in dates]
    return own, [one for one in series.changes if one.date not in dates]


def chart(series: Series, alarm: Alarm) -> str:
    """Returns an SVG of values with intervals, the line that describes them, the date of the alarm, other changes, and limits."""
    stamp = series.date.astype(np.int64).astype(float)
    span = max(stamp[-1] - stamp[0], 1.0)
    errors = _SIGMAS * np.where(np.isfinite(series.standard_errors), series.standard_errors, 0.0)
    bounds = [one for one in series.limits if one is not None]
    least = min([float((series.values - errors).min()), float(series.fitted.min()), *bounds])
    greatest = max([float((series.values + errors).max()), float(series.fitted.max()), *bounds])
    margin = 0.06 * (greatest - least) or 0.1 * abs(greatest) or 1.0
    least, greatest = least - margin, greatest + margin

    def x(at: Array) -> Array:
        return np.asarray(_LEFT + (_WIDTH - _LEFT - _RIGHT) * (0.02 + 0.96 * (at - stamp[0]) / span))

    def y(value: Array) -> Array:
        return np.asarray(_TOP + (_HEIGHT - _TOP - _BOTTOM) * (greatest - value) / (greatest - least))

    bottom, right = _HEIGHT - _BOTTOM, _WIDTH - _RIGHT
    parts = [f'<path class="axis" d="M{_LEFT},{_TOP}V{bottom}H{right}"/>']
    own, others = _changes(series, alarm)
    parts += [_upright("bend", float(x(np.array(_stamp(change.date))))) for change in others]
    for change in own:
        edges = x(np.array([_stamp(change.earliest), _stamp(change.latest)]))
        parts.append(
            f'<rect class="when" x="{edges[0] - 2:.1f}" y="{_TOP}" width="{edges[1] - edges[0] + 4:.1f}" height="{bottom - _TOP:.1f}"/>'
        )
    dates = [one.date for one in own] or [alarm.date]
    parts += [_upright("since", float(x(np.array(_stamp(date))))) for date in dates]
    parts += [f'<path class="limit" d="M{_LEFT},{float(y(np.array(bound))):.1f}H{right}"/>' for bound in bounds]
    places, heights, lows, highs = x(stamp), y(series.values), y(series.values - errors), y(series.values + errors)
    parts += [f'<path class="error" d="M{at:.1f},{low:.1f}V{high:.1f}"/>' for at, low, high in zip(places, lows, highs) if low - high > 1]
    parts += [f'<circle class="value" cx="{at:.1f}" cy="{height:.1f}" r="2.4"/>' for at, height in zip(places, heights)]
    parts.append(f'<path class="fitted" d="{_path(series, places, y(series.fitted))}"/>')
    parts += [_label(_LEFT - 6, float(y(np.array(value))) + 4, "end", text) for value, text in _ticks(least, greatest)]
    parts += [_label(float(x(np.array(at))), bottom + 18, "middle", text) for at, text in _dates(series)]
    name = f"{series.robot}, {series.cable}, {series.parameter} from {str(series.date[0])[:10]} to {str(series.date[-1])[:10]}"
    return f'<svg viewBox="0 0 {_WIDTH:.0f} {_HEIGHT:.0f}" role="img" aria-label="{escape(name)}">{"".join(parts)}</svg>'


def _path(series: Series, places: Array, heights: Array) -> str:
    steps = {int(np.searchsorted(series.date.astype(np.int64), _stamp(one.date))) for one in series.changes if one.kind == "step"}
    return "".join(
        f"{'M' if place in steps or place == 0 else 'L'}{at:.1f},{height:.1f}" for place, (at, height) in enumerate(zip(places, heights))
    )


def _upright(kind: str, at: float) -> str:
    return f'<path class="{kind}" d="M{at:.1f},{_TOP}V{_HEIGHT - _BOTTOM}"/>'


def _label(x: float, y: float, anchor: str, text: str) -> str:
    return f'<text x="{x:.1f}" y="{y:.1f}" text-anchor="{anchor}">{text}</text>'


def _ticks(least: float, greatest: float) -> list[tuple[float, str]]:
    """Returns round values between two bounds, with as many digits as their distance needs."""
    raw = (greatest - least) / _TICKS
    power = 10.0 ** np.floor(np.log10(raw))
    step = next(factor * power for factor in (1, 2, 5, 10) if factor * power >= raw * (1 - 1e-9))
    digits = max(0, -int(np.floor(np.log10(step) + 1e-9)))
    places = range(int(np.ceil(least / step)), int(np.floor(greatest / step)) + 1)
    return [(place * step, f"{place * step:.{digits}f}".replace("-", "−")) for place in places]


def _dates(series: Series) -> list[tuple[float, str]]:
    """Returns round dates from the first log to the last: first days of months, or days where the logs are of few months."""
    first, last = series.date[0], series.date[-1]
    months = np.arange(first.astype("datetime64[M]"), last.astype("datetime64[M]") + 1)
    days = np.arange(first.astype("datetime64[D]"), last.astype("datetime64[D]") + 1)
    if len(months) > 3:
        month = months.astype(np.int64)
        step = next((one for one in _MONTHS if len(months) <= _TICKS * one), _MONTHS[-1])
        ticks = months[month % step == 0]
    else:
        ticks = days[:: next((one for one in _DAYS if len(days) <= _TICKS * one), _DAYS[-1])]
    ticks = ticks[(ticks >= first) & (ticks <= last)]
    if len(ticks) < 2:
        ticks = np.unique(days[[0, -1]])
    return [(float(np.clip(tick.astype("datetime64[ns]"), first, last).astype(np.int64)), str(tick)) for tick in ticks]


def _stamp(date: datetime) -> float:
    return float(np.datetime64(date.replace(tzinfo=None), "ns").astype(np.int64))
