"""Page of a fleet: a self-contained HTML file that needs no network, for light and dark screens, for telephones, and for paper."""

from __future__ import annotations

import re
from html import escape

from .._results.base import counted
from ._alarms import day
from ._chart import chart, legend
from ._run import told_once
from ._trend import Alarm, Series, Trend
from ._words import TOO_FEW, between, has_course, headline, may_show_a_change, provenance, remarks, since, verdict

# Same style as the other pages of fric.
_STYLE = """
:root { color-scheme: light dark; --text: #1b1f24; --soft: #5d6773; --line: #c9d0d8; --page: #ffffff;
  --before: #b4610f; --after: #1664c0; --flag: #c9264a; --good: #1d7d4f; }
@media (prefers-color-scheme: dark) { :root { --text: #e6e9ed; --soft: #9aa5b1; --line: #3a434d; --page: #14181d;
  --before: #f0a35c; --after: #6db1ff; --flag: #ff7b93; --good: #58c793; } }
body { font: 16px/1.5 system-ui, sans-serif; color: var(--text); background: var(--page); max-width: 62rem;
  margin: 2rem auto; padding: 0 1rem; overflow-wrap: break-word; }
h1 { font-size: 1.5rem; } h2 { font-size: 1.15rem; margin: 2rem 0 .3rem; } h3 { font-size: 1rem; margin: 1.2rem 0 .3rem; }
p { margin: .3rem 0; } p.soft { color: var(--soft); }
.scroll { overflow-x: auto; }
table { border-collapse: collapse; margin: .5rem 0 1rem; font-variant-numeric: tabular-nums; }
caption { text-align: left; color: var(--soft); padding-bottom: .2rem; }
th, td { padding: .2rem .9rem .2rem 0; text-align: right; border-bottom: 1px solid var(--line); vertical-align: top; }
th { font-weight: 600; color: var(--soft); } th.words, td.words, tbody th { text-align: left; } tbody th { color: var(--text); }
td.number, .day { white-space: nowrap; }
footer { margin-top: 2.5rem; border-top: 1px solid var(--line); color: var(--soft); font-size: .8rem; }
.todo { border-left: 4px solid var(--after); padding: .1rem 0 .1rem .9rem; margin: 1rem 0; break-inside: avoid; } .todo h2 { margin: 0 0 .2rem; }
section.alarm { border-top: 2px solid var(--line); margin-top: 1.6rem; }
dl { display: grid; grid-template-columns: max-content 1fr; gap: .15rem 1rem; margin: .4rem 0; }
dt { color: var(--soft); } dd { margin: 0; }
.alarm h3 span { color: var(--flag); } .good { color: var(--good); font-weight: 600; }
.views { display: flex; flex-wrap: wrap; gap: 0 1.5rem; } figure { margin: .6rem 0; flex: 0 1 29rem; min-width: 0; break-inside: avoid; } figcaption { color: var(--soft); }
svg { width: 100%; height: auto; display: block; } svg text { fill: var(--soft); font: 12px system-ui, sans-serif; }
svg .axis { stroke: var(--line); stroke-width: 1; fill: none; } svg .value { fill: var(--before); } svg .error { stroke: var(--before); stroke-width: 1; }
svg .fitted { stroke: var(--after); stroke-width: 2; fill: none; stroke-linejoin: round; } svg .when { fill: var(--flag); opacity: .18; }
svg .since { stroke: var(--flag); stroke-width: 1.2; } svg .bend { stroke: var(--soft); stroke-width: 1.2; stroke-dasharray: 1 3; } svg .limit { stroke: var(--soft); stroke-width: 1.2; stroke-dasharray: 5 4; }
.legend { font-size: .85rem; } .keys { display: inline-block; margin-right: .9rem; } .key { display: inline-block; margin-right: .35em; vertical-align: -.1em; print-color-adjust: exact; }
.key.value { width: .45em; height: .45em; border-radius: 50%; background: var(--before); vertical-align: .15em; } .key.fitted { width: 1.1em; border-top: 2px solid var(--after); vertical-align: .25em; }
.key.since { height: .9em; border-left: 2px solid var(--flag); } .key.when { width: .9em; height: .9em; background: color-mix(in srgb, var(--flag) 18%, transparent); }
.key.bend { height: .9em; border-left: 2px dotted var(--soft); } .key.limit { width: 1.3em; border-top: 2px dashed var(--soft); vertical-align: .25em; }
a { color: var(--after); } a:focus-visible { outline: 2px solid var(--after); }
@media (max-width: 40rem) { table, caption, tbody, tr, td, tbody th { display: block; text-align: left; border: 0; padding: 0; } table { font-size: .85rem; }
  thead { position: absolute; left: -10000px; } tr { border-bottom: 1px solid var(--line); padding: .4rem 0; }
  .stacked td::before { content: attr(data-name) ": "; color: var(--soft); }
  .flowing td, .flowing tbody th { display: inline-block; padding-right: .7rem; } .flowing td.number::before { content: attr(data-name) " "; color: var(--soft); } }
@media print { body { max-width: none; margin: 0; font-size: 12px; } section.alarm { break-inside: avoid; } a { color: inherit; } }
"""
_REASONS = {"history": "changed", "limit": "beyond a limit", "last_log": "last log out of line"}


def page(trend: Trend) -> str:
    """Returns the whole page."""
    robots = list(dict.fromkeys(one.robot for one in trend.series))
    title = f"Fleet: {', '.join(robots) if len(robots) <= 3 else f'{len(robots)} robots'}"
    parts = [_to_do(trend), *(f'<p class="soft">{escape(text)}</p>' for text in remarks(trend))]
    parts += [
        _overview(trend),
        *(_alarm(trend, place, alarm) for place, alarm in enumerate(trend.alarms)),
        _robots(trend, robots),
        _failures(trend),
    ]
    return (
        '<!DOCTYPE html><html lang="en"><head><meta charset="utf-8"><meta name="viewport" content="width=device-width, initial-scale=1">'
        f"<title>{escape(title)}</title><style>{_STYLE}</style></head><body><main><h1>{escape(verdict(trend))}</h1>"
        f'<p class="soft">{escape(title)} · {escape(headline(trend))}</p>{"".join(parts)}</main>{_made()}</body></html>\n'
    )


def _to_do(trend: Trend) -> str:
    named = list(dict.fromkeys(f"{one.robot}, {one.cable}: {one.remedy}" for one in trend.alarms))
    sentences = named or ["Nothing: go on recording."]
    return f'<div class="todo"><h2>What to do</h2><ul>{"".join(f"<li>{escape(text)}</li>" for text in sentences)}</ul></div><h2>Evidence</h2>'


def _made() -> str:
    made = provenance()
    return f"<footer><p>Made by {made['program']} {made['version']} on {made['made']} with <code>{made['command']}</code></p></footer>"


def _overview(trend: Trend) -> str:
    if not trend.alarms and not may_show_a_change(trend):
        return f"<h2>What has changed</h2><p>Nothing can be told: {TOO_FEW}.</p>"
    if not trend.alarms and any(change.of_model for one in trend.series for change in one.changes):
        return "<h2>What has changed</h2><p>Values that go with another model or other options, and no others.</p>"
    if not trend.alarms:
        return '<h2>What has changed</h2><p class="good">Nothing: all parameters are what they were, within their scatter.</p>'
    rows = [
        [
            f'<a href="#alarm-{place}">{escape(one.robot)}, {escape(one.cable)}</a>',
            _days(since(one)),
            escape(one.text),
            escape(one.remedy),
        ]
        for place, one in enumerate(trend.alarms)
    ]
    return "<h2>What has changed</h2>" + _table("Alarms, the latest first", ["where", "since", "what", "to do"], rows, narrow="stacked")


def _alarm(trend: Trend, place: int, alarm: Alarm) -> str:
    shown = [one for one in trend.series if (one.robot, one.cable) == (alarm.robot, alarm.cable) and one.parameter in alarm.parameters]
    words = {"since": since(alarm), "what": alarm.text, "likely": alarm.cause, "to do": alarm.remedy}
    listed = "".join(f"<dt>{name}</dt><dd>{escape(text)}</dd>" for name, text in words.items())
    rows = [
        [
            escape(one.parameter),
            one.kind,
            _days(between(one)),
            f"{one.before:.4g}",
            f"{one.after:.4g}",
            _size(one.size, one.size_standard_error, one.kind),
            f"{one.delta_bic:.0f}".replace("-", "−"),
        ]
        for one in alarm.changes
    ]
    names = ["parameter", "kind", "since (95 %)", "before", "after", "size", "ΔBIC"]
    changes = _table("Changes; a ΔBIC of −10 is very strong evidence", names, rows, narrow="stacked") if rows else ""
    head = f"<h3>{escape(alarm.robot)}, {escape(alarm.cable)}: <span>{_REASONS[alarm.reason]}</span></h3>"
    shown.sort(key=lambda one: alarm.parameters.index(one.parameter))
    drawn = "".join(_figure(one, alarm) for one in shown)
    return f'<section class="alarm" id="alarm-{place}">{head}<dl>{listed}</dl><div class="views">{drawn}</div>{changes}</section>'


def _days(text: str) -> str:
    """Returns a text in which dates are not broken across lines."""
    return re.sub(r"\d{4}-\d\d-\d\d", r'<span class="day">\g<0></span>', escape(text))


def _size(size: float, error: float, kind: str) -> str:
    return f"{size:+.3g} ± {error:.1g}{' a year' if kind == 'slope' else ''}".replace("-", "−")


def _figure(series: Series, alarm: Alarm) -> str:
    caption = f"{series.parameter}: {counted(len(series.values), 'log')}; scatter from log to log {series.scatter:.2g}"
    keys = " ".join(f'<span class="keys"><span class="key {kind}"></span>{text}</span>' for kind, text in legend(series, alarm).items())
    return f'<figure>{chart(series, alarm)}<figcaption>{escape(caption)}<br><span class="legend">{keys}</span></figcaption></figure>'


def _robots(trend: Trend, robots: list[str]) -> str:
    parts = ["<h2>All robots</h2>"]
    for robot in robots:
        of_robot = [one for one in trend.series if one.robot == robot]
        rows = [
            [
                escape(one.cable),
                escape(one.parameter),
                str(len(one.values)),
                f"{one.fitted[0]:.4g}",
                f"{one.fitted[-1]:.4g}",
                f"{one.scatter:.2g}",
                _state(one),
            ]
            for one in of_robot
        ]
        days = sorted(date for one in of_robot for date in (one.date[0], one.date[-1]))
        caption = f"{robot}, {str(days[0])[:10]} to {str(days[-1])[:10]}"
        parts.append(_table(caption, ["cable", "parameter", "logs", "at first", "now", "scatter", "state"], rows, narrow="flowing"))
    return "".join(parts)


def _state(series: Series) -> str:
    if series.changes:
        return "; ".join(f"{one.kind} {day(one.date)}" for one in series.changes)
    return "wanders" if series.wanders else "steady" if has_course(series) else "too few dates"


def _failures(trend: Trend) -> str:
    if not trend.failures:
        return ""
    rows = [[escape(logs), escape(error)] for logs, error in told_once(trend.failures)]
    return "<h2>Logs without a result</h2>" + _table("", ["log", "why"], rows, narrow="stacked")


def _table(caption: str, names: list[str], rows: list[list[str]], *, narrow: str) -> str:
    """Returns a table whose cells are HTML. The first cell of each row is its header.

    On a narrow screen a cell is a line (`stacked`), or a row a line that breaks where it has to (`flowing`).
    """
    numbers = {"logs", "at first", "now", "scatter", "before", "after", "size", "ΔBIC"}
    kinds = ["number" if name in numbers else "words" for name in names]
    head = "".join(f'<th scope="col" role="columnheader" class="{kind}">{name}</th>' for name, kind in zip(names, kinds))
    body = "".join(
        f'<tr role="row"><th scope="row" role="rowheader">{row[0]}</th>'
        + "".join(
            f'<td role="cell" class="{kind}" data-name="{name}">{cell}</td>' for cell, kind, name in zip(row[1:], kinds[1:], names[1:])
        )
        + "</tr>"
        for row in rows
    )
    shown = f"<caption>{escape(caption)}</caption>" if caption else ""
    # The roles are needed on narrow screens, where the layout removes them from the elements.
    table = f'<table role="table" class="{narrow}">{shown}<thead role="rowgroup"><tr role="row">{head}</tr></thead>'
    label = escape(caption or " and ".join(names))
    return (
        f'<div class="scroll" tabindex="0" role="region" aria-label="{label}">{table}<tbody role="rowgroup">{body}</tbody></table></div>'
    )
