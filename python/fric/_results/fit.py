"""What a fit finds."""

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
    """Samples that were not learned from, by the reason."""

    flagged: int
    without_reference: int
    warm_up: int
    outliers: int


class OpenPart(TypedDict):
    """A parameter of a combination that the samples leave open."""

    cable: str
    parameter: str
    step: float


@dataclass(frozen=True, eq=False, repr=False)
class CableFit(Value):
    """What a fit found for a cable."""

    name: str
    """Name of the cable."""
    samples: int
    """Samples that were learned from."""
    left_out: LeftOut
    """Samples that were not learned from, by the reason."""
    termination: str
    """Why the search has ended: "converged", or why not."""
    evaluations: int
    """How often the model was evaluated with its derivatives."""
    values: dict[str, float]
    """Values by the robot file's keys, fitted or kept."""
    standard_errors: dict[str, float]
    """Standard errors of the fitted values."""
    undetermined: list[str]
    """What the samples do not determine: these values are kept as they were."""
    open: list[list[OpenPart]]
    """Combinations that the samples leave open, a list of parts each: `cable`, `parameter` and the `step` by which it changes with the
    others; the first part is what is kept of this cable."""
    at_bound: list[str]
    """What is at an end of its range, where the samples would have it beyond."""
    parameters: tuple[str, ...]
    """What was fitted, in the order of `covariance` and `correlation`."""
    covariance: NDArray[np.float64]
    """Covariance of the fitted parameters in their units, in the order of `parameters`."""
    correlation: NDArray[np.float64]
    """Their correlations, -1 to 1, in the same order."""
    residuals_n: NDArray[np.float64]
    """Compensated force less reference with these values, N, for every row of the logs one after the other; NaN where there is no
    reference, as everywhere in a fit to the wrench."""
    before: ForceError | None
    """Error of the sensor force turned into tension as if nothing rubbed; None without a reference."""
    after: ForceError | None
    """Error of the force compensated with these values; None without a reference."""
    faults: list[Fault]
    """Faults of the recording that were corrected before: a reference that comes late, or runs by another clock."""


@dataclass(frozen=True, eq=False, repr=False)
class FitResult(Result):
    """Outcome of a fit. `print(result)` shows values, errors, correlations and what is not determined; `summary()` is a table."""

    robot: Robot
    """The robot with the fitted values; all else, comments included, is as in the robot given."""
    reference: Literal["forces", "wrench", "mass"]
    """What was compared with: "forces", "wrench", or "mass" where the wrench is that of the platform's mass."""
    cables: tuple[CableFit, ...]
    """What was found for each cable, in the robot's order."""
    wrench: tuple[WrenchError, WrenchError] | None
    """Error of the wrench before and after; None in a fit to forces."""
    held_out: WrenchError | None
    """Error of the wrench on blocks of the log held out, with parameters from the other blocks; None in a fit to forces."""
    _report: str = field(repr=False, compare=False)

    def cable(self, name: str) -> CableFit:
        """What was found for the cable of a name."""
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
