"""Remaining hysteresis of the wrench."""

from __future__ import annotations

import json
from dataclasses import dataclass

from .base import Result, Shown, Value


@dataclass(frozen=True, eq=False, repr=False)
class Width(Value):
    """Width of a hysteresis."""

    width: float
    """Difference between the means of the two directions."""
    standard_error: float | None
    """Standard error of the width; None with a single pass in a direction."""

    @staticmethod
    def _of(entry: dict[str, float] | None) -> Width | None:
        return Width(entry["width"], entry.get("standard_error")) if entry else None


@dataclass(frozen=True, eq=False, repr=False)
class AxisHysteresis(Value):
    """Hysteresis along or about one axis."""

    axis: str
    """ "x", "y", "z" along the axes of the base, "a", "b", "c" about them."""
    unit: str
    """Unit of the widths."""
    passes: int
    """Number of passes in both directions together; 0 for an axis that is not crossed."""
    without: Width | None
    """Width from forces without compensation; None for an axis that is not crossed."""
    compensated: Width | None
    """Width from compensated forces; None for an axis that is not crossed."""
    lasting_ratio: float | None
    """Width with compensation divided by the width without; None if the latter is only scatter."""
    applied_subtracted: bool | None
    """Whether the external wrench of the log was subtracted."""


@dataclass(frozen=True, eq=False, repr=False)
class HysteresisResult(Result):
    """Result of `hysteresis`. `print(result)` shows all of it."""

    robot: str
    """Name of the robot."""
    axes: tuple[AxisHysteresis, ...]
    """Axes x, y, z, a, b, c."""
    position_m: tuple[float, float, float]
    """Position that is crossed, base frame, m."""

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
