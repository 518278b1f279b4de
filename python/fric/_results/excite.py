"""Runs for the identification of a robot."""

from __future__ import annotations

from dataclasses import dataclass, field
from html import escape
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .base import Value


@dataclass(frozen=True, eq=False, repr=False)
class ExciteResult(Value):
    """Set points of an identification run or of a run designed for a question, one row per cycle. The columns are the cables in the order of the
    robot. `print(result)` shows the demands on the robot."""

    robot: str
    """Name of the robot."""
    cable_names: tuple[str, ...]
    """Names of the cables in the order of the columns."""
    phases: tuple[str, ...]
    """Names of the phases of the movement, which `phase` indexes."""
    phase: NDArray[np.uint8]
    """Index into `phases`, (N,)."""
    time_s: NDArray[np.float64]
    """Time since the start, s, (N,)."""
    position_m: NDArray[np.float64] | None
    """Position of the platform, base frame, m, (N, 3); None for a robot without a platform."""
    orientation_xyzw: NDArray[np.float64] | None
    """Orientation of the platform as a unit quaternion, (N, 4)."""
    velocity_m_per_s: NDArray[np.float64] | None
    """Velocity of the platform, m/s, (N, 3)."""
    acceleration_m_per_s2: NDArray[np.float64] | None
    """Acceleration of the platform, m/s², (N, 3)."""
    length_m: NDArray[np.float64]
    """Length of the cables, m, (N, cables)."""
    speed_m_per_s: NDArray[np.float64]
    """Rate of change of the lengths, m/s, (N, cables)."""
    tension_n: NDArray[np.float64] | None
    """Cable forces at the platform, N, (N, cables). None if not all cables are attached to it and the run states no load of a test bench."""
    expectations: tuple[str, ...]
    """Expected findings of a designed run, one line for each question; empty for the identification run."""
    _summary: str = field(repr=False, compare=False)
    _html: str = field(repr=False, compare=False)

    def summary(self) -> str:
        """Returns the text that `fric-cli excite` prints for the run."""
        return self._summary

    def to_html(self) -> str:
        """Returns the page of `fric-cli excite --preview`: a self-contained HTML file that needs no network."""
        return self._html

    def __len__(self) -> int:
        return len(self.time_s)

    def __str__(self) -> str:
        return self._summary

    def _repr_html_(self) -> str:
        return f"<p>{escape(self.robot)}: {escape(self._summary)}</p>" + super()._repr_html_()

    @classmethod
    def _of(
        cls,
        names: tuple[str, tuple[str, ...], tuple[str, ...]],
        times: tuple[Any, Any],
        platform: tuple[Any, Any, Any, Any],
        cables: tuple[Any, Any],
        tension_n: Any,
        expectations: tuple[str, ...],
        texts: tuple[str, str],
    ) -> ExciteResult:
        return cls(*names, *times, *platform, *cables, tension_n, expectations, *texts)
