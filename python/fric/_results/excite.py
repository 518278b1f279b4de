"""The run that identifies a robot."""

from __future__ import annotations

from dataclasses import dataclass, field
from html import escape
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .base import Value


@dataclass(frozen=True, eq=False, repr=False)
class ExciteResult(Value):
    """Set points of an identification run, or of one designed for a question, a row a cycle; columns of cables are the robot's in order. `print(result)` says how hard it is."""

    robot: str
    """Name of the robot."""
    cable_names: tuple[str, ...]
    """Names of the cables in the order of the columns."""
    phases: tuple[str, ...]
    """What the movement is for: the names that `phase` counts."""
    phase: NDArray[np.uint8]
    """Place in `phases`, (N,)."""
    time_s: NDArray[np.float64]
    """Time since the start, s, (N,)."""
    position_m: NDArray[np.float64] | None
    """Position of the platform, base frame, m, (N, 3); None for a robot without."""
    orientation_xyzw: NDArray[np.float64] | None
    """Its orientation as a unit quaternion, (N, 4)."""
    velocity_m_per_s: NDArray[np.float64] | None
    """Its velocity, m/s, (N, 3)."""
    acceleration_m_per_s2: NDArray[np.float64] | None
    """Its acceleration, m/s², (N, 3)."""
    length_m: NDArray[np.float64]
    """Length of the cables, m, (N, cables)."""
    speed_m_per_s: NDArray[np.float64]
    """Its rate, m/s, (N, cables)."""
    tension_n: NDArray[np.float64] | None
    """Cable forces at the platform, N, (N, cables); None where not all cables are attached to it, and the run states no load of a test bench."""
    expectations: tuple[str, ...]
    """What a designed run is expected to tell, a line for each question; empty for the identification run."""
    _summary: str = field(repr=False, compare=False)
    _html: str = field(repr=False, compare=False)

    def summary(self) -> str:
        """What `fric-cli excite` prints of the run."""
        return self._summary

    def to_html(self) -> str:
        """The page of `fric-cli excite --preview`, one file without network access."""
        return self._html

    def __len__(self) -> int:
        return len(self.time_s)

    def __str__(self) -> str:
        return self._summary

    def _repr_html_(self) -> str:
        return f"<p>{escape(self.robot)}: {escape(self._summary)}</p>"

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
