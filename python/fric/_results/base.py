"""Base classes of all results."""

from __future__ import annotations

import json
from dataclasses import dataclass, field, fields
from typing import Any, NamedTuple, Protocol, TypeVar

import numpy as np

from .. import _html
from .._arguments import must_be
from .._errors import ConfigError
from .._fric import _unknown_name
from .._read_only import read_only

# If the text of a list or dict is longer, `repr` shows only the number of its entries.
_LONGEST_TEXT = 200


class Shown(NamedTuple):
    """Texts of a result for people and for machines."""

    summary: str
    json: str
    html: str
    table: str


@dataclass(frozen=True, eq=False, repr=False)
class Value:
    """Immutable record. Two are equal if all fields are equal, where NaN equals NaN. Its arrays, lists, and dicts are read-only."""

    def __post_init__(self) -> None:
        vars(self).update({name: read_only(value) for name, value in vars(self).items()})

    def __setstate__(self, state: dict[str, Any]) -> None:
        # Pickling loses the read-only flag of arrays.
        vars(self).update({name: read_only(value) for name, value in state.items()})

    def __eq__(self, other: object) -> bool:
        if type(other) is not type(self):
            return NotImplemented
        names = [one.name for one in fields(self) if one.compare]
        return all(_same(getattr(self, name), getattr(other, name)) for name in names)

    # Arrays have no hash.
    __hash__ = None  # type: ignore[assignment]

    def _texts(self) -> list[tuple[str, str]]:
        return [(one.name, _text(getattr(self, one.name))) for one in fields(self) if one.repr]

    def __repr__(self) -> str:
        return f"{type(self).__name__}({', '.join(map('='.join, self._texts()))})"

    def _repr_html_(self) -> str:
        return _html.fields(type(self).__name__, self._texts())


@dataclass(frozen=True, eq=False, repr=False)
class Result(Value):
    """Result with the texts that the command line prints and writes for it."""

    _shown: Shown = field(repr=False, compare=False)

    def summary(self) -> str:
        """Returns the text that the command line prints."""
        return self._shown.summary

    def to_json(self) -> str:
        """Returns the text that the command line writes with `--json`."""
        return self._shown.json

    def to_dict(self) -> dict[str, Any]:
        """Returns the content of `to_json` as a dict."""
        table: dict[str, Any] = json.loads(self._shown.json)
        return table

    def to_html(self) -> str:
        """Returns a self-contained HTML page that needs no network: the report of the command line, if it has one."""
        return self._shown.html

    def _repr_html_(self) -> str:
        return self._shown.table

    def __str__(self) -> str:
        return self._shown.summary


def counted(count: int, thing: str) -> str:
    """Returns a number of things, such as "1 log" or "2 logs"."""
    return f"{count} {thing}{'' if count == 1 else 's'}"


class _Named(Protocol):
    @property
    def name(self) -> str: ...


_Cable = TypeVar("_Cable", bound=_Named)


def of_cable(cables: tuple[_Cable, ...], name: str) -> _Cable:
    """Returns the cable with the given name."""
    must_be("name", name, "a text", str)
    for cable in cables:
        if cable.name == name:
            return cable
    raise ConfigError(_unknown_name("cable", name, [cable.name for cable in cables]))


def _same(one: Any, other: Any) -> bool:
    """Returns whether two values are equal, where NaN equals NaN."""
    if isinstance(one, np.ndarray) and isinstance(other, np.ndarray):
        # Only NaN differs from itself.
        equal = one.shape == other.shape and one.dtype == other.dtype
        return equal and bool(((one == other) | ((one != one) & (other != other))).all())
    if isinstance(one, dict) and isinstance(other, dict):
        return one.keys() == other.keys() and all(_same(value, other[key]) for key, value in one.items())
    if isinstance(one, (list, tuple)) and type(one) is type(other):
        return len(one) == len(other) and all(map(_same, one, other))
    return bool(one == other) or (isinstance(one, float) and isinstance(other, float) and one != one and other != other)


def _text(value: Any) -> str:
    """Returns the text of a value for `repr`. Of values too long for the screen, it states the number of entries."""
    if isinstance(value, np.ndarray):
        return f"<{value.dtype} array of shape {value.shape}>"
    text = repr(value)
    if len(text) > _LONGEST_TEXT and isinstance(value, (list, dict)):
        return f"<{type(value).__name__} of {len(value)}>"
    return text
