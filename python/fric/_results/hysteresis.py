"""What is left of the wrench's hysteresis."""

from __future__ import annotations

import json
from dataclasses import dataclass

from .base import Result, Shown, Value


@dataclass(frozen=True, eq=False, repr=False)
class Width(Value):
    """Width of a hysteresis."""

    width: float
    """Difference of the means in either direction."""
    standard_error: float | None
    """Its standard error; None with a single pass in a direction."""

    @staticmethod
    def _of(entry: dict[str, float] | None) -> Width | None:
        return Width(entry["width"], entry.get("standard_error")) if entry else None


@dataclass(frozen=True, eq=False, repr=False)
class AxisHysteresis(Value):
    """The hysteresis along, or about, one axis."""

    axis: str
    """ "x", "y", "z" along the axes of the base, "a", "b", "c" about them."""
    unit: str
    """Unit of the widths."""
    passes: int
    """Passes in both directions together; 0 for an axis that is not crossed."""
    without: Width | None
    """From forces without compensation; None for an axis that is not crossed."""
    compensated: Width | None
    """From compensated forces; None for an axis that is not crossed."""
    lasting_ratio: float | None
    """Width with compensation per width without; None where the latter is none but scatter."""
    applied_subtracted: bool | None
    """Whether the log's own outside wrench was taken off."""


@dataclass(frozen=True, eq=False, repr=False)
class HysteresisResult(Result):
    """Outcome of `hysteresis`. `print(result)` shows all of it."""

    robot: str
    """Name of the robot."""
    axes: tuple[AxisHysteresis, ...]
    """The axes x, y, z, a, b, c."""
    position_m: tuple[float, float, float]
    """The position that is crossed, base frame, m."""

    @classmethod
    def _of(cls, shown: Shown, position_m: tuple[float, float, float]) -> HysteresisResult:
        found = json.loads(shown.json)
        axes = tuple(
            AxisHysteresis(
                axis=axis["axis"],
                unit=axis["unit"],
                passes=axis["passes"],
                without=Width._of(axis.get("without")),
                compensated=Width._of(axis.get("with")),
                lasting_ratio=axis.get("lasting_ratio"),
                applied_subtracted=axis.get("applied_subtracted"),
            )
            for axis in found["axes"]
        )
        return cls(shown, found["robot"], axes, position_m)
