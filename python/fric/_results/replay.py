"""Errors of forces and wrenches, cycles of a compensator, and what a replay finds."""

from __future__ import annotations

import json
from dataclasses import dataclass
from typing import Any, Literal, TypedDict

import numpy as np
from numpy.typing import NDArray

from .base import Result, Shown, Value, of_cable


@dataclass(frozen=True, eq=False, repr=False)
class ForceError(Value):
    """Deviation of a force from the reference."""

    rms_n: float
    """Root mean square, N."""
    mae_n: float
    """Mean of the magnitude, N."""

    @staticmethod
    def _of(entry: dict[str, float] | None) -> ForceError | None:
        return ForceError(**entry) if entry else None


@dataclass(frozen=True, eq=False, repr=False)
class WrenchError(Value):
    """Deviation of the wrench from the one in the log."""

    force_rms_n: float
    """Root mean square of the force deviation's length, N."""
    torque_rms_nm: float
    """The same of the torque, N m."""

    @staticmethod
    def _pair(entry: dict[str, Any] | None) -> tuple[WrenchError, WrenchError] | None:
        return (WrenchError(**entry["before"]), WrenchError(**entry["after"])) if entry else None


class Fault(TypedDict):
    """A fault of the recording: it says something about the log, not about the machine."""

    kind: Literal[
        "hum",
        "noisy_length",
        "frozen",
        "clipped",
        "spikes",
        "coarse_converter",
        "reference_delay",
        "clock_skew",
    ]
    parameters: dict[str, float]
    intervals_s: list[list[float]]


@dataclass(frozen=True, eq=False, repr=False)
class CableErrors(Value):
    """What a replay found for a cable."""

    name: str
    """Name of the cable."""
    samples: int
    """Cycles run."""
    flagged: int
    """Cycles with any flag."""
    flags: int
    """Each flag of `Status` that was raised, as bits."""
    before: ForceError | None
    """Error of the sensor force turned into tension as if nothing rubbed; None without a reference."""
    after: ForceError | None
    """Error of the compensated force; None without a reference."""
    faults: list[Fault]
    """Faults of the recording that were corrected before, with `correct`."""


@dataclass(frozen=True, eq=False, repr=False)
class Compensation(Value):
    """Outcome of a cycle (a number per cable), or of as many cycles as there are rows. The arrays cannot be written to."""

    force_at_platform_n: NDArray[np.float64]
    """Cable force at the platform, N, the offset included."""
    friction_n: NDArray[np.float64]
    """Estimated friction, N: positive where it makes the platform side tighter."""
    frictionless_n: NDArray[np.float64]
    """The sensor force turned into cable tension as if nothing rubbed, N."""
    status: NDArray[np.uint32]
    """Bits of `Status`."""
    outside_wrench: NDArray[np.float64] | None
    """Force (N) and torque (N m) on the platform from outside, gravity included; NaN in cycles without, None without any."""


@dataclass(frozen=True, eq=False, repr=False)
class ReplayResult(Result):
    """Outcome of a replay; the arrays have a row per row of the log. `print(result)` shows the errors."""

    robot: str
    """Name of the robot."""
    cables: tuple[CableErrors, ...]
    """What was found for each cable, in the robot's order."""
    wrench: tuple[WrenchError, WrenchError] | None
    """Error of the wrench before and after; None without a wrench in the log."""
    wrench_reference: Literal["wrench", "mass"] | None
    """What the wrench is compared with: "wrench" in the log, or "mass" of the platform."""
    force_at_platform_n: NDArray[np.float64]
    """Cable forces at the platform, N."""
    friction_n: NDArray[np.float64]
    """Estimated friction, N."""
    frictionless_n: NDArray[np.float64]
    """Sensor forces turned into tension as if nothing rubbed, N."""
    status: NDArray[np.uint32]
    """Bits of `Status`."""
    outside_wrench: NDArray[np.float64] | None
    """Force and torque on the platform from outside, gravity included; NaN while the pose or a cable's force is not known, None if it
    never is."""

    def cable(self, name: str) -> CableErrors:
        """What was found for the cable of a name."""
        return of_cable(self.cables, name)

    @classmethod
    def _of(cls, shown: Shown, flags: list[int], cycles: Compensation) -> ReplayResult:
        found = json.loads(shown.json)
        wrench = found.get("wrench")
        cables = tuple(
            CableErrors(
                name=cable["name"],
                samples=cable["samples"],
                flagged=cable["flagged"],
                flags=bits,
                before=ForceError._of(cable.get("before")),
                after=ForceError._of(cable.get("after")),
                faults=cable.get("faults", []),
            )
            for cable, bits in zip(found["cables"], flags)
        )
        return cls(
            shown, found["robot"], cables, WrenchError._pair(wrench), wrench and wrench["reference"], **vars(cycles)
        )
