"""Results of a discovery."""

from __future__ import annotations

import json
from dataclasses import dataclass
from typing import Any, Literal, Optional, TypedDict

import numpy as np
from numpy.typing import NDArray

from .._fric import Robot
from .base import Result, Shown, Value, counted, of_cable
from .fit import LeftOut, LogValues
from .replay import Fault, ForceError


class Missing(TypedDict):
    """Data that a log lacks for a verdict."""

    cause: str
    advice: str


# `from` is a keyword, which the class syntax does not allow as a key.
Where = TypedDict(
    "Where",
    {
        "signal": str,
        "from": float,
        "to": float,
        "unit": str,
        "share_of_excess": Optional[float],
        "share_of_samples": Optional[float],
        "explains": Optional[float],
        "significance": Optional[float],
        "intervals_s": list[list[float]],
    },
)


class Evidence(TypedDict):
    """Evidence for an effect."""

    delta_bic: float | None
    held_out_rms_n: float | None


class Candidate(Evidence):
    """Effect added alone to the given model."""

    kind: str


class Tried(TypedDict):
    """Effect that improves the model but is not sufficient."""

    kind: str
    evidence: Evidence
    reason: str


class RunnerUp(Candidate):
    """Second-best candidate."""

    as_good: bool


class TablePoint(TypedDict):
    """One point of a table: the condition, the change of the table there, and its standard error."""

    at: float
    value: float
    standard_error: float | None


class Table(TypedDict):
    """Content of an `empirical` table: an effect without a name, described by its size and where it occurs."""

    status: Literal["unnamed"]
    changes: Literal["force", "friction"]
    value_unit: str
    over: Literal["speed", "length", "load"]
    unit: str
    points: list[TablePoint]
    looks_like: list[str]


class Effect(TypedDict):
    """Effect that was found."""

    kind: str
    parameters: dict[str, float]
    standard_errors: dict[str, float]
    gap_closed: float | None
    evidence: Evidence
    runner_up: RunnerUp | None
    table: Table | None


class Revised(TypedDict):
    """Parameter of an effect of the robot file that the log has otherwise."""

    parameter: str
    given: float
    value: float
    standard_error: float


Unexplained = TypedDict(
    "Unexplained",
    {
        "rms_n": Optional[float],
        "where": list[Where],
        "intervals_s": list[list[float]],
        "goes_with": list[str],
    },
)


class CommonParameter(TypedDict):
    """Parameter over several cables."""

    key: str
    unit: str
    mean: float
    standard_error: float
    differs: bool
    least: float
    greatest: float


class CommonEffect(TypedDict):
    """Effect that several cables have."""

    kind: str
    cables: list[str]
    parameters: list[CommonParameter]


class WrenchSizes(TypedDict):
    """Root mean square of force and torque."""

    force_rms_n: float
    torque_rms_nm: float


class WrenchComponent(TypedDict):
    """One component, "fx_n" to "tz_nm": its white noise, and its deviation before and after."""

    name: str
    noise: float
    before: float
    after: float


class WrongNumber(TypedDict):
    """Key of the robot file whose numbers are wrong, with the numbers that it should have."""

    kind: str
    cable: str | None
    parameters: dict[str, float]
    evidence: Evidence


class TriedTogether(TypedDict):
    """Candidate that improves all cables together but is not sufficient: an effect, or a key of the robot file with its cable."""

    kind: str
    cable: str | None
    reason: str


class WrenchGap(TypedDict):
    """Findings on all cables together, if they were compared with the wrench."""

    reference: Literal["wrench", "mass"]
    verdict: Literal["complete", "extended", "unexplained"]
    before: WrenchSizes | None
    after: WrenchSizes | None
    noise_floor: WrenchSizes
    components: list[WrenchComponent]
    alike: list[str]
    geometry: list[WrongNumber]
    inertia_kg_m2: list[float] | None
    tried: list[TriedTogether]


@dataclass(frozen=True, eq=False, repr=False)
class CableDiscovery(Value):
    """Result of a discovery for one cable. Dicts and lists are as in the result of `fric-cli discover --json`.

    Arrays have one entry for every row of the logs, concatenated. They are empty if no verdict is possible.
    """

    name: str
    """Name of the cable."""
    samples: int
    """Number of samples used."""
    left_out: LeftOut
    """Number of samples not used, by reason."""
    held_out_samples: list[list[int]]
    """Rows of the held-out samples, `[from, to]` with `to` excluded. They were not used for training."""
    held_out_s: list[list[float]]
    """Times of the held-out samples, s since the first row."""
    noise_floor_n: float | None
    """Standard deviation of the white noise, N."""
    wander_n: float | None
    """Standard deviation of slow noise that is unrelated to the motion, N."""
    reference_variation_n: float | None
    """Standard deviation of the reference over the held-out samples, N: the error of a model that predicts a constant."""
    before: ForceError | None
    """Error of the given model after a fit, on the held-out samples."""
    after: ForceError | None
    """Error of the extended model on the held-out samples."""
    gap_closed: float | None
    """Fraction of the gap (the error above the noise) that the extended model closes; None if there is no gap."""
    verdict: Literal["complete", "extended", "unexplained"] | None
    """ "complete"; "extended" by an effect, so that the residual is noise; "unexplained"; or None if the log does not allow a verdict."""
    missing: Missing | None
    """Data that the log lacks for a verdict, with cause and advice; None if it lacks none."""
    where: list[Where]
    """Ranges of the conditions in which the given model disagrees, most significant first."""
    effects: list[Effect]
    """Effects found, in the order in which they were added: kind, parameters, standard_errors, gap_closed, evidence, runner_up, and, only for
    `empirical` (the residual that has no name), table."""
    candidates: list[Candidate]
    """Every effect added alone to the given model, best first."""
    tried: list[Tried]
    """Candidates that improve the extended model but are not sufficient, best first: kind, evidence, and reason."""
    parameters: dict[str, float]
    """Values of the extended model by the keys of the robot file. Those of an effect are named like "stribeck.ratio"."""
    standard_errors: dict[str, float]
    """Standard errors of the fitted values."""
    at_bound: list[str]
    """Friction parameters at the greatest value of their range, which the samples would exceed."""
    undetermined: list[str]
    """Parameters whose given value the log contradicts without determining a better one: `parameters` has one of many that agree with the log."""
    revised: list[Revised]
    """Parameters of the robot file's effects whose fitted value differs from the given one by more than its 95 % interval."""
    per_log: list[LogValues]
    """What each log has of its own (`discover(..., per_log=[...])`), in the order of the logs; empty if they share all values. `parameters` has that of
    the last log."""
    faults: list[Fault]
    """Faults of the recording, which were corrected before the model was compared with the log."""
    unexplained: Unexplained | None
    """Residual that no effect explains; None if there is none."""
    where_in_words: list[str]
    """Ranges of `where` in words, such as "at speeds below 20 mm/s"."""
    time_s: NDArray[np.float64]
    """Time since the first row, s; several logs are concatenated."""
    residual_before_n: NDArray[np.float64]
    """Residual of the given model after a fit, N; NaN where a row is not used."""
    residual_after_n: NDArray[np.float64]
    """Residual of the extended model, N."""

    def __repr__(self) -> str:
        found = "".join(f", {effect['kind']}" for effect in self.effects)
        return f"<CableDiscovery {json.dumps(self.name, ensure_ascii=False)}: {self.verdict}{found}>"


@dataclass(frozen=True, eq=False, repr=False)
class DiscoverResult(Result):
    """Result of a discovery. `print(result)` shows all of it, `result.plot("cable1")` one cable."""

    robot: Robot
    """Robot with the findings. All else, including comments, is as in the given robot."""
    cables: tuple[CableDiscovery, ...]
    """Findings for each cable, in the order of the robot."""
    common_effects: list[CommonEffect]
    """Effects that several cables have, with the mean of their parameters over these cables."""
    wrench: WrenchGap | None
    """Wrench before and after, effects that all cables have alike, and wrong numbers of the robot file, as in the result of `fric-cli discover
    --reference wrench --json`. None if the reference is forces."""

    def cable(self, name: str) -> CableDiscovery:
        """Returns the findings for the cable with the given name."""
        return of_cable(self.cables, name)

    def plot(self, cable: str) -> Any:
        """Draws `fric.plot.gap_ladder`, `where`, and `candidates` of a cable into one figure and returns it. Needs matplotlib."""
        from ..plot import _discovery

        return _discovery(self, cable)

    def __repr__(self) -> str:
        extended = sum(bool(cable.effects) for cable in self.cables)
        name = json.dumps(self.robot.name, ensure_ascii=False)
        return f"<DiscoverResult of {name}: {counted(len(self.cables), 'cable')}, effects found on {extended}>"

    @classmethod
    def _of(
        cls,
        shown: Shown,
        robot: Robot,
        cables: list[tuple[list[str], NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]],
    ) -> DiscoverResult:
        found = json.loads(shown.json)
        of_cables = tuple(
            CableDiscovery(
                before=ForceError._of(cable.pop("before", None)),
                after=ForceError._of(cable.pop("after", None)),
                at_bound=cable.pop("at_bound", []),
                undetermined=cable.pop("undetermined", []),
                revised=cable.pop("revised", []),
                per_log=cable.pop("per_log", []),
                where_in_words=words,
                time_s=time_s,
                residual_before_n=before_n,
                residual_after_n=after_n,
                **cable,
            )
            for cable, (words, time_s, before_n, after_n) in zip(found["cables"], cables)
        )
        return cls(shown, robot, of_cables, found["common_effects"], found.get("wrench"))
