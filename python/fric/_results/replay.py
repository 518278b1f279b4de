"""Errors of forces and wrenches, cycles of a compensator, and results of a replay."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Literal, TypedDict

import numpy as np
from numpy.typing import NDArray

from .base import Result, Shown, Value, of_cable


def _overflown(entry: Mapping[str, float | None]) -> dict[str, float]:
    """Returns errors in which null, which is JSON for a sum of squares that overflows, is infinity."""
    return {name: math.inf if value is None else value for name, value in entry.items()}


@dataclass(frozen=True, eq=False, repr=False)
class ForceError(Value):
    """Deviation of a force from the reference."""

    rms_n: float
    """Root mean square, N."""
    mae_n: float
    """Mean of the magnitude, N."""

    @staticmethod
    def _of(entry: dict[str, float] | None) -> ForceError | None:
        return ForceError(**_overflown(entry)) if entry else None


@dataclass(frozen=True, eq=False, repr=False)
class WrenchError(Value):
    """Deviation of the wrench from that in the log."""

    force_rms_n: float
    """Root mean square of the magnitude of the force deviation, N."""
    torque_rms_nm: float
    """Root mean square of the magnitude of the torque deviation, N m."""

    @staticmethod
    def _pair(entry: dict[str, Any] | None) -> tuple[WrenchError, WrenchError] | None:
        return (WrenchError(**_overflown(entry["before"])), WrenchError(**_overflown(entry["after"]))) if entry else None


class Fault(TypedDict):
    """Fault of the recording: a property of the log, not of the machine."""

    kind: Literal[
        "hum",
        "vibration",
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
    """Result of a replay for one cable."""

    name: str
    """Name of the cable."""
    samples: int
    """Number of cycles run."""
    flagged: int
    """Number of cycles with any flag."""
    flags: int
    """All flags of `Status` that were raised, as bits."""
    before: ForceError | None
    """Error of the tension computed from the sensor force without friction; None without a reference."""
    after: ForceError | None
    """Error of the compensated force; None without a reference."""
    faults: list[Fault]
    """Faults of the recording that were corrected before the replay, with `correct`."""


@dataclass(frozen=True, eq=False, repr=False)
class ComputedPoses(Value):
    """Poses that are not those of the log."""

    source: Literal["lengths"]
    """What they were computed from: the cable "lengths"."""
    samples: int
    """Number of samples with a pose."""
    missing: int
    """Number of samples without a pose."""
    residual_rms_m: float | None
    """Error of the lengths at the poses, rms over cables and samples, m; None without a pose, and for a part of a log."""

    @staticmethod
    def _of(entry: dict[str, Any] | None) -> ComputedPoses | None:
        return ComputedPoses(**{"residual_rms_m": None, **entry}) if entry else None


@dataclass(frozen=True, eq=False, repr=False)
class Compensation(Value):
    """Output of one cycle (one number per cable), or of several (one row per cycle). The arrays are read-only."""

    force_at_platform_n: NDArray[np.float64]
    """Cable force at the platform, N, including the offset."""
    friction_n: NDArray[np.float64]
    """Estimated friction, N: positive if it increases the tension on the platform side."""
    frictionless_n: NDArray[np.float64]
    """Cable tension computed from the sensor force without friction, N."""
    status: NDArray[np.uint32]
    """Bits of `Status`."""
    outside_wrench: NDArray[np.float64] | None
    """External force (N) and torque (N m) on the platform, including gravity. NaN in cycles without it, None if no cycle has it."""


@dataclass(frozen=True, eq=False, repr=False)
class ReplayResult(Result):
    """Result of a replay. The arrays have one row per row of the log. `print(result)` shows the errors."""

    robot: str
    """Name of the robot."""
    cables: tuple[CableErrors, ...]
    """Results for each cable, in the order of the robot."""
    wrench: tuple[WrenchError, WrenchError] | None
    """Error of the wrench before and after; None without a wrench in the log."""
    wrench_reference: Literal["wrench", "mass"] | None
    """Reference of the wrench: "wrench" in the log, or the one computed from the "mass" of the platform."""
    pose: ComputedPoses | None
    """The poses, if the robot says that they come from the lengths; None if they are those of the log."""
    force_at_platform_n: NDArray[np.float64]
    """Cable forces at the platform, N."""
    friction_n: NDArray[np.float64]
    """Estimated friction, N."""
    frictionless_n: NDArray[np.float64]
    """Cable tensions computed from the sensor forces without friction, N."""
    status: NDArray[np.uint32]
    """Bits of `Status`."""
    outside_wrench: NDArray[np.float64] | None
    """External force and torque on the platform, including gravity. NaN while the pose or the force of a cable is not known, None if they never
    are."""

    def cable(self, name: str) -> CableErrors:
        """Returns the result for the cable with the given name."""
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
        pose, reference = ComputedPoses._of(found.get("pose")), wrench and wrench["reference"]
        return cls(shown, found["robot"], cables, WrenchError._pair(wrench), reference, pose, **vars(cycles))
