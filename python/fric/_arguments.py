"""Checks of arguments."""

from __future__ import annotations

from typing import Any

from ._errors import ArgumentTypeError

_LONGEST_TEXT = 60


def refusal(expected: str, value: Any, name: str | None = None) -> ArgumentTypeError:
    """Returns the error of an argument that is not what it must be. Without a name, the compiled part adds it, as a note."""
    kind = type(value).__name__
    try:
        text = repr(value)
    except Exception:  # noqa: BLE001
        text = ""
    is_shown = 0 < len(text) <= _LONGEST_TEXT and "\n" not in text and not text.startswith("<")
    sentence = f"must be {expected}; what came is {f'{text} ({kind})' if is_shown else f'of class {kind}'}"
    return ArgumentTypeError(sentence if name is None else f"`{name}` {sentence}")


def must_be(name: str, value: Any, expected: str, *kinds: type) -> None:
    """Raises ArgumentTypeError unless an argument is of one of these classes."""
    if not isinstance(value, kinds) or (isinstance(value, bool) and bool not in kinds):
        raise refusal(expected, value, name)
