"""Arrays, lists, and dicts that nobody changes."""

from __future__ import annotations

from typing import Any, NoReturn

import numpy as np


def _refuse(self: Any, *arguments: Any, **named: Any) -> NoReturn:
    kind = "dict" if isinstance(self, dict) else "list"
    raise TypeError(f"this {kind} is read-only; change a copy, `{kind}(...)`")


class ReadOnlyDict(dict[Any, Any]):
    """Dict that cannot be changed; equal to a dict with the same content."""

    __setitem__ = __delitem__ = __ior__ = clear = pop = popitem = setdefault = update = _refuse

    def __reduce__(self) -> tuple[type[ReadOnlyDict], tuple[dict[Any, Any]]]:
        return (ReadOnlyDict, (dict(self),))


class ReadOnlyList(list[Any]):
    """List that cannot be changed; equal to a list with the same content."""

    __setitem__ = __delitem__ = __iadd__ = __imul__ = append = clear = extend = insert = pop = remove = reverse = sort = _refuse

    def __reduce__(self) -> tuple[type[ReadOnlyList], tuple[list[Any]]]:
        return (ReadOnlyList, (list(self),))


def read_only(value: Any) -> Any:
    """Makes arrays read-only and returns lists and dicts as ones that cannot be changed, down to the innermost; other values as they are."""
    if isinstance(value, np.ndarray):
        value.flags.writeable = False
    if isinstance(value, dict):
        return ReadOnlyDict({key: read_only(one) for key, one in value.items()})
    if isinstance(value, list):
        return ReadOnlyList(map(read_only, value))
    if type(value) is tuple:
        return tuple(map(read_only, value))
    return value
