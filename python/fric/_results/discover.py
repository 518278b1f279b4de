"""What a discovery finds."""

from __future__ import annotations

import json
from dataclasses import dataclass
from typing import Any, Literal, Optional, TypedDict

import numpy as np
from numpy.typing import NDArray

from .._fric import Robot
from .base import Result, Shown, Value, of_cable
from .fit import LeftOut
from .replay import Fault, ForceError


class Missing(TypedDict):
    """What a log lacks for a verdict."""

    cause: str
    advice: str


# `from` is a keyword, so that its declaration is no class.
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
    """How sure an effect is."""

    delta_bic: float | None
    held_out_rms_n: float | None


class Candidate(Evidence):
    """An effect beside the given model."""

    kind: str


class Tried(TypedDict):
    """An effect that helps and does not suffice."""

    kind: str
    evidence: Evidence
    reason: str


class RunnerUp(Candidate):
    """The next best name."""

    as_good: bool


class TablePoint(TypedDict):
    """One place of a table: the condition, what the table changes there, and its standard error."""

    at: float
    value: float
    standard_error: float | None


class Table(TypedDict):
    """What an `empirical` table says, which is no name: how large something is and where."""

    status: Literal["unnamed"]
    changes: Literal["force", "friction"]
    value_unit: str
    over: Literal["speed", "length", "load"]
    unit: str
    points: list[TablePoint]
    looks_like: list[str]


class Effect(TypedDict):
    """An effect that was found."""

    kind: str
    parameters: dict[str, float]
    standard_errors: dict[str, float]
    gap_closed: float | None
    evidence: Evidence
    runner_up: RunnerUp | None
    table: Table | None


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
    """A parameter over several cables."""

    key: str
    unit: str
    mean: float
    standard_error: float
    differs: bool
    least: float
    greatest: float


class CommonEffect(TypedDict):
    """An effect that several cables have."""

    kind: str
    cables: list[str]
    parameters: list[CommonParameter]


class WrenchSizes(TypedDict):
    """Root mean square of force and torque."""

    force_rms_n: float
    torque_rms_nm: float


class WrenchComponent(TypedDict):
    """One component, "fx_n" to "tz_nm": its white noise and the deviation before and after."""

    name: str
    noise: float
    before: float
    after: float


class WrongNumber(TypedDict):
    """A key of the robot file with the numbers that it should have."""

    kind: str
    cable: str | None
    parameters: dict[str, float]
    evidence: Evidence


class TriedTogether(TypedDict):
    """What helps all cables together and does not suffice."""

    kind: str
    reason: str


class WrenchGap(TypedDict):
    """What concerns all cables together, where they were compared with the wrench."""

    reference: Literal["wrench", "mass"]
    verdict: Literal["complete", "extended", "unexplained"]
    before: WrenchSizes | None
    after: WrenchSizes | None
    noise_floor: WrenchSizes
    components: list[WrenchComponent]
    alike: list[str]
    geometry: list[WrongNumber]
    tried: list[TriedTogether]


@dataclass(frozen=True, eq=False, repr=False)
class CableDiscovery(Value):
    """What a discovery found for a cable. Dicts and lists are as in the result of `fric-cli discover --json`.

    Arrays have an entry for every row of the logs one after the other; they are empty where nothing can be told.
    """

    name: str
    """Name of the cable."""
    samples: int
    """Samples that count."""
    left_out: LeftOut
    """Samples that do not count, by the reason."""
    held_out_samples: list[list[int]]
    """Rows that judge and were not learned from, `[from, to]` without the last."""
    held_out_s: list[list[float]]
    """When they are, s since the first row."""
    noise_floor_n: float | None
    """Standard deviation of the white noise, N."""
    wander_n: float | None
    """Standard deviation of slow noise that has nothing to do with the motion, N."""
    reference_variation_n: float | None
    """Standard deviation of the reference over the samples that judge, N: the error of a model that predicts a constant."""
    before: ForceError | None
    """Error of the given model, fitted, on the samples held out."""
    after: ForceError | None
    """Error of the extended model on the same samples."""
    gap_closed: float | None
    """Share of the gap, what is above the noise, that the extended model has closed; None where there is no gap."""
    verdict: Literal["complete", "extended", "unexplained"] | None
    """"complete", "extended" by an effect with which what is left is noise, "unexplained", or None where the log does not allow to
    tell."""
    missing: Missing | None
    """What the log lacks for a verdict, cause and advice; None if nothing."""
    where: list[Where]
    """Ranges of the conditions in which the given model disagrees, what tells most first."""
    effects: list[Effect]
    """Effects that were found, in the order in which they entered: kind, parameters, standard_errors, gap_closed, evidence,
    runner_up, and table, which only `empirical` has: what is left and has no name."""
    candidates: list[Candidate]
    """Every effect by itself beside the given model, the best first."""
    tried: list[Tried]
    """Candidates that help the extended model and do not suffice, the best first: kind, evidence and reason."""
    parameters: dict[str, float]
    """Values of the extended model by the robot file's keys, those of an effect as "stribeck.ratio"."""
    standard_errors: dict[str, float]
    """Standard errors of those fitted."""
    faults: list[Fault]
    """Faults of the recording, corrected before model and log were compared."""
    unexplained: Unexplained | None
    """What no effect accounts for; None if nothing."""
    where_in_words: list[str]
    """The ranges of `where` in words, such as "at speeds below 20 mm/s"."""
    time_s: NDArray[np.float64]
    """Time since the first row, s; several logs one after the other."""
    residual_before_n: NDArray[np.float64]
    """Residual of the given model, fitted, N; NaN where a row does not count."""
    residual_after_n: NDArray[np.float64]
    """Residual of the extended model, N."""

    def __repr__(self) -> str:
        found = "".join(f", {effect['kind']}" for effect in self.effects)
        return f"<CableDiscovery {json.dumps(self.name, ensure_ascii=False)}: {self.verdict}{found}>"


@dataclass(frozen=True, eq=False, repr=False)
class DiscoverResult(Result):
    """Outcome of a discovery. `print(result)` shows all of it, `result.plot("cable1")` a cable."""

    robot: Robot
    """The robot with what was found; all else, comments included, is as in the robot given."""
    cables: tuple[CableDiscovery, ...]
    """What was found for each cable, in the robot's order."""
    common_effects: list[CommonEffect]
    """Effects that several cables have, with the mean of their parameters over these."""
    wrench: WrenchGap | None
    """The wrench before and after, effects that all cables have alike and wrong numbers of the robot file, as in the result of
    `fric-cli discover --reference wrench --json`; None where the reference are forces."""

    def cable(self, name: str) -> CableDiscovery:
        """What was found for the cable of a name."""
        return of_cable(self.cables, name)

    def plot(self, cable: str) -> Any:
        """Draws a cable: `fric.plot.gap_ladder`, `where` and `candidates` in one figure, which it returns; needs matplotlib."""
        from ..plot import _discovery

        return _discovery(self, cable)

    def __repr__(self) -> str:
        extended = sum(bool(cable.effects) for cable in self.cables)
        name = json.dumps(self.robot.name, ensure_ascii=False)
        return f"<DiscoverResult of {name}: {len(self.cables)} cables, effects found on {extended}>"

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
                where_in_words=words,
                time_s=time_s,
                residual_before_n=before_n,
                residual_after_n=after_n,
                **cable,
            )
            for cable, (words, time_s, before_n, after_n) in zip(found["cables"], cables)
        )
        return cls(shown, robot, of_cables, found["common_effects"], found.get("wrench"))
