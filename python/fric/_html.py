"""Tables for notebooks."""

from __future__ import annotations

from html import escape
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from ._fric import Robot

_FRICTION = ("mu", "sigma_n_per_m", "viscous_n_s_per_m", "offset_n")


def table(head: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """Returns an HTML table; the first cell of a row names it."""
    names = "".join(f"<th>{escape(name)}</th>" for name in head)
    body = "".join(f"<tr><th>{escape(name)}</th>{''.join(f'<td>{escape(cell)}</td>' for cell in cells)}</tr>" for name, *cells in rows)
    return f"<table><thead><tr>{names}</tr></thead><tbody>{body}</tbody></table>"


def fields(class_name: str, pairs: Iterable[tuple[str, str]]) -> str:
    """Returns the names and values of an object as a table."""
    return table((class_name, "value"), pairs)


def robot(of: Robot) -> str:
    """Returns the cables of a robot with their friction and their effects as a table."""
    rows = []
    for cable in of.cables:
        effects = ", ".join(str(effect["kind"]) for effect in cable.effects)
        values = (getattr(cable.friction, name) for name in _FRICTION)
        rows.append((cable.name, f"{len(cable.pulleys)}", *("–" if value is None else f"{value:g}" for value in values), effects or "–"))
    return f"<p>{escape(of.name)}: cycle {of.cycle_s:g} s</p>" + table(("cable", "pulleys", *_FRICTION, "effects"), rows)
