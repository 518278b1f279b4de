"""Drawing of a series in a page."""

from __future__ import annotations

from datetime import datetime
from html import escape

import numpy as np

from ._noise import Array
from ._trend import Series

# Letters stay readable if the drawing is as wide as the screen of a telephone.
_WIDTH, _HEIGHT = 460.0, 210.0
_LEFT, _RIGHT, _TOP, _BOTTOM = 62.0, 10.0, 14.0, 26.0
# Two-sided 95 % quantile of the normal distribution.
_SIGMAS = 1.96


def chart(series: Series) -> str:
    """Returns an SVG of values with intervals, the line that describes them, dates of changes, and limits."""
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
    for change in series.changes:
        edges = x(np.array([_stamp(change.earliest), _stamp(change.latest)]))
        at = float(x(np.array(_stamp(change.date))))
        parts.append(
            f'<rect class="when" x="{edges[0] - 2:.1f}" y="{_TOP}" width="{edges[1] - edges[0] + 4:.1f}" height="{bottom - _TOP:.1f}"/>'
        )
        parts.append(f'<path class="since" d="M{at:.1f},{_TOP}V{bottom}"/>')
    parts += [f'<path class="limit" d="M{_LEFT},{float(y(np.array(bound))):.1f}H{right}"/>' for bound in bounds]
    places, heights, lows, highs = x(stamp), y(series.values), y(series.values - errors), y(series.values + errors)
    parts += [f'<path class="error" d="M{at:.1f},{low:.1f}V{high:.1f}"/>' for at, low, high in zip(places, lows, highs) if low - high > 1]
    parts += [f'<circle class="value" cx="{at:.1f}" cy="{height:.1f}" r="2.4"/>' for at, height in zip(places, heights)]
    parts.append(f'<path class="fitted" d="{_path(series, places, y(series.fitted))}"/>')
    parts += _labels(series, least, greatest)
    name = f"{series.robot}, {series.cable}, {series.parameter} from {str(series.date[0])[:10]} to {str(series.date[-1])[:10]}"
    return f'<svg viewBox="0 0 {_WIDTH:.0f} {_HEIGHT:.0f}" role="img" aria-label="{escape(name)}">{"".join(parts)}</svg>'


def _path(series: Series, places: Array, heights: Array) -> str:
    steps = {int(np.searchsorted(series.date.astype(np.int64), _stamp(one.date))) for one in series.changes if one.kind == "step"}
    return "".join(
        f"{'M' if place in steps or place == 0 else 'L'}{at:.1f},{height:.1f}" for place, (at, height) in enumerate(zip(places, heights))
    )


def _labels(series: Series, least: float, greatest: float) -> list[str]:
    bottom = _HEIGHT - _BOTTOM
    labels = []
    for share in (0.1, 0.5, 0.9):
        value = least + share * (greatest - least)
        height = bottom - share * (bottom - _TOP)
        labels.append(f'<text x="{_LEFT - 6}" y="{height + 4:.1f}" text-anchor="end">{_short(value, greatest - least)}</text>')
    for share, anchor in ((0.0, "start"), (1.0, "end")):
        date = series.date[0] + (series.date[-1] - series.date[0]) * int(share)
        at = _LEFT if share == 0 else _WIDTH - _RIGHT
        labels.append(f'<text x="{at}" y="{bottom + 18}" text-anchor="{anchor}">{str(date)[:10]}</text>')
    return labels


def _short(value: float, span: float) -> str:
    """Formats a value with as many digits as are needed to distinguish values within a span."""
    digits = max(0, 2 - int(np.floor(np.log10(span))))
    return (f"{value:.{digits}f}" if digits < 6 else f"{value:.3g}").replace("-", "−")


def _stamp(date: datetime) -> float:
    return float(np.datetime64(date.replace(tzinfo=None), "ns").astype(np.int64))
