"""Results of a fit."""

from __future__ import annotations

import json
from dataclasses import dataclass, field
from typing import Literal, TypedDict

import numpy as np
from numpy.typing import NDArray

from .._fric import Robot
from .base import Result, Shown, Value, of_cable
from .replay import Fault, ForceError, WrenchError


class LeftOut(TypedDict):
    """Samples not used for the fit, by reason."""

    flagged: int
    without_reference: int
    warm_up: int
    outliers: int


class LogValues(TypedDict):
    """What a log has of its own: its name, values, and their standard errors. Without a sample that counts it has no values."""

    log: str
    parameters: dict[str, float]
    standard_errors: dict[str, float]


class OpenPart(TypedDict):
    """Parameter of a combination that the samples do not determine."""

    cable: str
    parameter: str
    step: float


@dataclass(frozen=True, eq=False, repr=False)
class CableFit(Value):
    """Result of a fit for one cable."""

    name: str
    """Name of the cable."""
    samples: int
    """Number of samples used for the fit."""
    left_out: LeftOut
    """Number of samples not used for the fit, by reason."""
    termination: str
    """Reason for which the search ended: "converged", or why it did not converge."""
    evaluations: int
    """Number of evaluations of the model with its derivatives."""
    values: dict[str, float]
    """Values by the keys of the robot file, fitted or kept."""
    standard_errors: dict[str, float]
    """Standard errors of the fitted values."""
    undetermined: list[str]
    """Parameters that the samples do not determine. They keep their given values."""
    per_log: list[LogValues]
    """What each log has of its own (`fit(..., per_log=[...])`), in the order of the logs; empty if they share all values. `values` has that of the
    last log."""
    open: list[list[OpenPart]]
    """Combinations that the samples do not determine, each a list of parts: `cable`, `parameter`, and the `step` by which the parameter changes with
    the others. The first part is the parameter of this cable that is kept."""
    at_bound: list[str]
    """Parameters at a limit of their range that the samples would exceed."""
    parameters: tuple[str, ...]
    """Fitted parameters, in the order of `covariance` and `correlation`."""
    covariance: NDArray[np.float64]
    """Covariance of the fitted parameters in their units, in the order of `parameters`."""
    correlation: NDArray[np.float64]
    """Correlations of the fitted parameters, -1 to 1, in the same order."""
    residuals_n: NDArray[np.float64]
    """Compensated force minus the reference with these values, N, for every row of the logs, concatenated. NaN where there is no reference, and
    everywhere in a fit to the wrench."""
    before: ForceError | None
    """Error of the tension computed from the sensor force without friction; None without a reference."""
    after: ForceError | None
    """Error of the force compensated with these values; None without a reference."""
    faults: list[Fault]
    """Faults of the recording that were corrected before the fit: a delayed reference, or a reference on a different clock."""


@dataclass(frozen=True, eq=False, repr=False)
class FitResult(Result):
    """Result of a fit. `print(result)` shows values, errors, correlations, and undetermined parameters; `summary()` is a table."""

    robot: Robot
    """Robot with the fitted values. All else, including comments, is as in the given robot."""
    reference: Literal["forces", "wrench", "mass"]
    """Reference of the fit: "forces", "wrench", or "mass" if the wrench is computed from the mass of the platform."""
    cables: tuple[CableFit, ...]
    """Results for each cable, in the order of the robot."""
    wrench: tuple[WrenchError, WrenchError] | None
    """Error of the wrench before and after; None in a fit to forces."""
    held_out: WrenchError | None
    """Error of the wrench on held-out blocks of the log, with parameters from the other blocks; None in a fit to forces."""
    _report: str = field(repr=False, compare=False)

    def cable(self, name: str) -> CableFit:
        """Returns the result for the cable with the given name."""
        return of_cable(self.cables, name)

    def __str__(self) -> str:
        return self._report

    @classmethod
    def _of(
        cls,
        shown: Shown,
        report: str,
        robot: Robot,
        cables: list[tuple[list[str], NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]],
    ) -> FitResult:
        found = json.loads(shown.json)
        wrench = found.get("wrench")
        fitted = tuple(
            CableFit(
                values=cable.pop("parameters"),
                parameters=tuple(parameters),
                covariance=covariance,
                correlation=correlation,
                residuals_n=residuals_n,
                before=ForceError._of(cable.pop("before", None)),
                after=ForceError._of(cable.pop("after", None)),
                faults=cable.pop("faults", []),
                per_log=cable.pop("per_log", []),
                **{key: value for key, value in cable.items() if key != "mean_reference_n"},
            )
            for cable, (parameters, covariance, correlation, residuals_n) in zip(found["cables"], cables)
        )
        held_out = wrench and wrench.get("held_out")
        return cls(
            shown,
            robot,
            found["reference"],
            fitted,
            WrenchError._pair(wrench),
            WrenchError(**held_out) if held_out else None,
            report,
        )
