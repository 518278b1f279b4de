"""What the work on a manipulator finds."""

from __future__ import annotations

import json
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from .._errors import ConfigError
from .._fric import Manipulator, TendonRun, _unknown_name
from .base import Result, Shown, Value


@dataclass(frozen=True, eq=False, repr=False)
class CalibrationResult(Result):
    """Outcome of `calibrate`: `T = a·Δλ + b` for each grating. Arrays have one entry for each grating; ratios are shares of the greatest
    load."""

    manipulator: Manipulator
    """The manipulator with these coefficients; all else, comments included, is as in the one given."""
    newton_per_nm: NDArray[np.float64]
    """Slope a, N/nm."""
    offset_n: NDArray[np.float64]
    """Offset b, N."""
    standard_error_n: NDArray[np.float64]
    """Greatest standard error of a tension from one shift within the loads, N."""
    largest_residual_ratio: NDArray[np.float64]
    """Largest residual."""
    largest_left_out_ratio: NDArray[np.float64]
    """Largest error at a load of the line through all others."""

    @classmethod
    def _of(cls, shown: Shown, manipulator: Manipulator) -> CalibrationResult:
        gratings = json.loads(shown.json)["gratings"]

        def each(key: str) -> NDArray[np.float64]:
            return np.array([grating[key] for grating in gratings], dtype=np.float64)

        return cls(
            shown,
            manipulator,
            each("newton_per_nm"),
            each("offset_n"),
            each("standard_error_n"),
            each("largest_residual_ratio"),
            each("largest_left_out_ratio"),
        )


@dataclass(frozen=True, eq=False, repr=False)
class FrictionResult(Result):
    """Outcome of `friction`: arrays with a row a sample and a column a hole, from the base plate. Friction is positive where the base side
    is tighter, NaN where it is not known."""

    time_s: NDArray[np.float64]
    """Time, s, (N,)."""
    friction_n: NDArray[np.float64]
    """Friction, N, (N, holes)."""
    standard_error_n: NDArray[np.float64]
    """Its standard error, N, (N, holes)."""
    directions_differ: NDArray[np.bool_]
    """Whether friction has both directions beyond doubt, (N,)."""


@dataclass(frozen=True, eq=False, repr=False)
class HoleResult(Result):
    """Outcome of `hole`."""

    mu: float
    """Friction coefficient."""
    standard_error: float
    """Its standard error."""
    interval: tuple[float, float]
    """The interval that holds it in 95 of 100 cases."""


@dataclass(frozen=True, eq=False, repr=False)
class Shape(Value):
    """Outcome of `StaticModel.solve`; of `run` with one more axis in front, a row a step. Index 0 of (2, disks) is the first tendon. All numbers
    are finite, whatever went in."""

    disk_position_m: NDArray[np.float64]
    """Centres of the disks, base frame, m, (disks, 2)."""
    segment_bend_rad: NDArray[np.float64]
    """Bend of each segment, rad, (disks,)."""
    bend_rad: NDArray[np.float64]
    """Bend of the whole manipulator, rad, ()."""
    tension_n: NDArray[np.float64]
    """Tension in each segment, N, (2, disks)."""
    friction_n: NDArray[np.float64]
    """Friction at each hole, N, (2, disks); positive where the base side is tighter."""
    bound_n: NDArray[np.float64]
    """Greatest friction at each hole, N, (2, disks)."""
    status: NDArray[np.uint32]
    """Bits of `ShapeStatus`, ()."""
    is_new: NDArray[np.bool_]
    """Whether this is the shape for the tensions given, (); otherwise it is the last one that was right."""


@dataclass(frozen=True, eq=False, repr=False)
class Command(Value):
    """Outcome of `StaticModel.tension_for`; of `follow` with one more axis in front, a row a goal. It holds what to set at the base, and what the
    model expects of it."""

    base_tension_n: NDArray[np.float64]
    """Tensions at the base of the first and the second tendon, N, (2,)."""
    bend_rad: NDArray[np.float64]
    """Bend of the whole manipulator then, rad, ()."""
    tip_m: NDArray[np.float64]
    """Centre of the last disk then, base frame, m, (2,)."""
    status: NDArray[np.uint32]
    """Bits of `GoalStatus`, ()."""
    is_reached: NDArray[np.bool_]
    """Whether the goal is reached, ()."""


@dataclass(frozen=True, eq=False, repr=False)
class ShapeResult(Result):
    """Outcome of `shape`. `ways` names the ways of friction that the run allows; arrays of a way have a row a sample."""

    ways: tuple[str, ...]
    """Names of the ways: "none", "coulomb", "measured", "history"."""
    time_s: NDArray[np.float64]
    """Time, s, (N,)."""
    shapes: list[dict[str, Any]]
    """The shapes that were picked, as dicts: time_s, tension_base_n, marker_m, and by each way errors, disk_position_m, friction_n …"""
    errors: list[dict[str, Any]]
    """Errors of each way, as dicts: way, picked and all with max_mm and mean_mm, missing."""
    _series: dict[str, dict[str, Any]]

    def disk_position_m(self, way: str) -> NDArray[np.float64]:
        """Centres of the disks by a way, base frame, m, (N, disks, 2)."""
        return self._of_way(way, "disk_position_m")

    def friction_n(self, way: str) -> NDArray[np.float64]:
        """Friction at each hole by a way, N, (N, holes)."""
        return self._of_way(way, "friction_n")

    def tension_n(self, way: str) -> NDArray[np.float64]:
        """Tension in each segment by a way, N, (N, disks)."""
        return self._of_way(way, "tension_n")

    def bend_rad(self, way: str) -> NDArray[np.float64]:
        """Bend of the manipulator by a way, rad, (N,)."""
        return self._of_way(way, "bend_rad")

    def _of_way(self, way: str, key: str) -> NDArray[np.float64]:
        if way not in self._series:
            raise ConfigError(_unknown_name("way", way, list(self.ways)))
        values: NDArray[np.float64] = self._series[way][key]
        return values

    def __repr__(self) -> str:
        return f"<ShapeResult of {len(self.time_s)} samples: {', '.join(self.ways)}>"

    @classmethod
    def _of(
        cls, shown: Shown, time_s: NDArray[np.float64], series: dict[str, dict[str, Any]]
    ) -> ShapeResult:
        found = json.loads(shown.json)
        return cls(shown, tuple(series), time_s, found["shapes"], found["ways"], series)


@dataclass(frozen=True, eq=False, repr=False)
class SimulatedTendon(Value):
    """Outcome of `simulate`: what was measured, and what was really there."""

    run: TendonRun
    """What was measured."""
    load_n: NDArray[np.float64]
    """Loads of a calibration of the same gratings, N, (10,)."""
    load_shift_nm: NDArray[np.float64]
    """Their shifts, nm, (10, disks)."""
    mu: NDArray[np.float64]
    """True friction coefficient of each hole."""
    friction_n: NDArray[np.float64]
    """True friction at each hole, N, (N, holes)."""
    bound_n: NDArray[np.float64]
    """What each hole could truly hold, N, (N, holes)."""
    tension_n: NDArray[np.float64]
    """True tension in each segment, N, (N, disks)."""


@dataclass(frozen=True, eq=False, repr=False)
class TendonDiscovery(Result):
    """Outcome of `discover`. Arrays have a row for each sample that was compared: the run thinned, with every turn of the tension."""

    manipulator: Manipulator
    """The manipulator with what was found; all else, comments included, is as in the one given."""
    time_s: NDArray[np.float64]
    """Time, s, (N,)."""
    residual_before_n: NDArray[np.float64]
    """Tension by the gratings less that of the given model, fitted, N, (N, disks); NaN where nothing was measured."""
    residual_after_n: NDArray[np.float64]
    """The same with the extended model, N, (N, disks)."""
    verdict: Literal["complete", "extended", "unexplained"]
    """"complete", "extended" by what was found, with which what is left is noise, or "unexplained"."""
    effects: list[dict[str, Any]]
    """What was found, as dicts: kind, parameters, standard_errors, gap_closed, evidence, runner_up, and alike, the names of effects
    that the run does not tell from it, where there are any."""
    markers: dict[str, Any] | None
    """Distances between disks and markers under the tensions that the gratings show, as a dict: noise_mm, calibration_error_mm, before,
    after; None where too few markers tell their noise."""
    tried: list[dict[str, Any]]
    """Candidates that helped and did not suffice, best first, as dicts: kind, parameters, evidence, reason."""
    kept: str | None
    """Why the file keeps a μ that the run contradicts: shapes would be worse; None where it keeps none."""
    unexplained: dict[str, Any] | None
    """What no effect accounts for, as a dict: rms_n, rms_mm, where, goes_with; None where nothing is left."""

    @classmethod
    def _of(
        cls,
        shown: Shown,
        manipulator: Manipulator,
        time_s: NDArray[np.float64],
        residual_before_n: NDArray[np.float64],
        residual_after_n: NDArray[np.float64],
    ) -> TendonDiscovery:
        tendon = json.loads(shown.json)["cables"][0]
        keys = ("verdict", "effects", "markers", "tried", "kept", "unexplained")
        found = {key: tendon.get(key) for key in keys}
        return cls(shown, manipulator, time_s, residual_before_n, residual_after_n, **found)


@dataclass(frozen=True, eq=False, repr=False)
class TendonFit(Result):
    """Outcome of `fit`. Dicts go by keys such as "bending_stiffness_n_m2", which carry their unit."""

    manipulator: Manipulator
    """The manipulator with the values found; all else, comments included, is as in the one given."""
    parameters: dict[str, float]
    """Values found."""
    standard_errors: dict[str, float]
    """Their standard errors."""
    given: dict[str, float]
    """Values of the manipulator given."""
    undetermined: list[dict[str, Any]]
    """What the runs cannot tell, as dicts: parameters (the first stays as given), sentence."""
    before: dict[str, float]
    """How far the manipulator given is off, as a dict: tension_rms_n, marker_mean_mm, marker_max_mm; a key is absent where there is nothing to
    compare."""
    after: dict[str, float]
    """The same of the fitted one."""

    @classmethod
    def _of(cls, shown: Shown, manipulator: Manipulator) -> TendonFit:
        found = json.loads(shown.json)
        keys = ("parameters", "standard_errors", "given", "undetermined", "before", "after")
        return cls(shown, manipulator, **{key: found[key] for key in keys})
