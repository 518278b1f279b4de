"""Results of the analyses of manipulators."""

from __future__ import annotations

import json
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from .._arguments import must_be
from .._errors import ConfigError
from .._fric import Manipulator, TendonRun, _unknown_name
from .base import Result, Shown, Value, counted


@dataclass(frozen=True, eq=False, repr=False)
class CalibrationResult(Result):
    """Result of `calibrate`: `T = a·Δλ + b` for each grating. Arrays have one entry for each grating. Ratios are relative to the greatest load."""

    manipulator: Manipulator
    """Manipulator with these coefficients. All else, including comments, is as in the given one."""
    newton_per_nm: NDArray[np.float64]
    """Slope a, N/nm."""
    offset_n: NDArray[np.float64]
    """Offset b, N."""
    standard_error_n: NDArray[np.float64]
    """Greatest standard error of a tension from one shift within the range of the loads, N."""
    largest_residual_ratio: NDArray[np.float64]
    """Largest residual, relative to the greatest load."""
    largest_left_out_ratio: NDArray[np.float64]
    """Largest error at a load that was left out of the fit of the line."""

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
    """Result of `friction`. Arrays have one row per sample and one column per hole, from the base plate. Friction is positive if the tension on the
    base side is greater, and NaN if it is not known."""

    time_s: NDArray[np.float64]
    """Time, s, (N,)."""
    friction_n: NDArray[np.float64]
    """Friction, N, (N, holes)."""
    standard_error_n: NDArray[np.float64]
    """Standard error of the friction, N, (N, holes)."""
    directions_differ: NDArray[np.bool_]
    """Whether friction acts in both directions with statistical significance, (N,)."""


@dataclass(frozen=True, eq=False, repr=False)
class HoleResult(Result):
    """Result of `hole`."""

    mu: float
    """Friction coefficient."""
    standard_error: float
    """Standard error of the coefficient."""
    interval: tuple[float, float]
    """95 % confidence interval of the coefficient."""


@dataclass(frozen=True, eq=False, repr=False)
class Shape(Value):
    """Result of `StaticModel.solve`. That of `run` has one more leading axis, with one row per step. Index 0 of (2, disks) is the first tendon. All
    numbers are finite for any input."""

    disk_position_m: NDArray[np.float64]
    """Centres of the disks, base frame, m, (disks, 2)."""
    segment_bend_rad: NDArray[np.float64]
    """Bend of each segment, rad, (disks,)."""
    bend_rad: NDArray[np.float64]
    """Bend of the whole manipulator, rad, ()."""
    tension_n: NDArray[np.float64]
    """Tension in each segment, N, (2, disks)."""
    friction_n: NDArray[np.float64]
    """Friction at each hole, N, (2, disks); positive if the tension on the base side is greater."""
    bound_n: NDArray[np.float64]
    """Greatest friction at each hole, N, (2, disks)."""
    status: NDArray[np.uint32]
    """Bits of `ShapeStatus`, ()."""
    is_new: NDArray[np.bool_]
    """Whether this is the shape for the given tensions, (). Otherwise it is the last valid shape."""


@dataclass(frozen=True, eq=False, repr=False)
class Command(Value):
    """Result of `StaticModel.tension_for`. That of `follow` has one more leading axis, with one row per goal. It holds the tensions to set at the
    base and the prediction of the model for them."""

    base_tension_n: NDArray[np.float64]
    """Tensions at the base of the first and the second tendon, N, (2,)."""
    bend_rad: NDArray[np.float64]
    """Predicted bend of the whole manipulator, rad, ()."""
    tip_m: NDArray[np.float64]
    """Predicted centre of the last disk, base frame, m, (2,)."""
    status: NDArray[np.uint32]
    """Bits of `GoalStatus`, ()."""
    is_reached: NDArray[np.bool_]
    """Whether the goal is reached, ()."""


@dataclass(frozen=True, eq=False, repr=False)
class ShapeResult(Result):
    """Result of `shape`. `ways` names the sources of friction that the run allows. The arrays of each source have one row per sample."""

    ways: tuple[str, ...]
    """Names of the sources of friction: "none", "coulomb", "measured", "history"."""
    time_s: NDArray[np.float64]
    """Time, s, (N,)."""
    shapes: list[dict[str, Any]]
    """Selected shapes, as dicts: time_s, tension_base_n, marker_m, and for each source of friction errors, disk_position_m, friction_n …"""
    errors: list[dict[str, Any]]
    """Errors for each source of friction, as dicts: way, picked and all with max_mm and mean_mm, missing."""
    _series: dict[str, dict[str, Any]]

    def disk_position_m(self, way: str) -> NDArray[np.float64]:
        """Returns the centres of the disks for a source of friction, base frame, m, (N, disks, 2)."""
        return self._of_way(way, "disk_position_m")

    def friction_n(self, way: str) -> NDArray[np.float64]:
        """Returns the friction at each hole for a source of friction, N, (N, holes)."""
        return self._of_way(way, "friction_n")

    def tension_n(self, way: str) -> NDArray[np.float64]:
        """Returns the tension in each segment for a source of friction, N, (N, disks)."""
        return self._of_way(way, "tension_n")

    def bend_rad(self, way: str) -> NDArray[np.float64]:
        """Returns the bend of the manipulator for a source of friction, rad, (N,)."""
        return self._of_way(way, "bend_rad")

    def _of_way(self, way: str, key: str) -> NDArray[np.float64]:
        must_be("way", way, "a text", str)
        if way not in self._series:
            raise ConfigError(_unknown_name("way", way, list(self.ways)))
        values: NDArray[np.float64] = self._series[way][key]
        return values

    def __repr__(self) -> str:
        return f"<ShapeResult of {counted(len(self.time_s), 'sample')}: {', '.join(self.ways)}>"

    @classmethod
    def _of(
        cls, shown: Shown, time_s: NDArray[np.float64], series: dict[str, dict[str, Any]]
    ) -> ShapeResult:
        found = json.loads(shown.json)
        return cls(shown, tuple(series), time_s, found["shapes"], found["ways"], series)


@dataclass(frozen=True, eq=False, repr=False)
class SimulatedTendon(Value):
    """Result of `simulate`: the measured run and the true values."""

    run: TendonRun
    """Measured run."""
    load_n: NDArray[np.float64]
    """Loads of a calibration of the same gratings, N, (10,)."""
    load_shift_nm: NDArray[np.float64]
    """Wavelength shifts at these loads, nm, (10, disks)."""
    mu: NDArray[np.float64]
    """True friction coefficient of each hole."""
    friction_n: NDArray[np.float64]
    """True friction at each hole, N, (N, holes)."""
    bound_n: NDArray[np.float64]
    """True greatest friction of each hole, N, (N, holes)."""
    tension_n: NDArray[np.float64]
    """True tension in each segment, N, (N, disks)."""


@dataclass(frozen=True, eq=False, repr=False)
class TendonDiscovery(Result):
    """Result of `discover`. Arrays have one row for each sample that was compared: the run thinned out, with every reversal of the tension."""

    manipulator: Manipulator
    """Manipulator with the findings. All else, including comments, is as in the given one."""
    time_s: NDArray[np.float64]
    """Time, s, (N,)."""
    residual_before_n: NDArray[np.float64]
    """Tension from the gratings minus that of the given model after a fit, N, (N, disks); NaN where nothing was measured."""
    residual_after_n: NDArray[np.float64]
    """Tension from the gratings minus that of the extended model, N, (N, disks)."""
    verdict: Literal["complete", "extended", "unexplained"]
    """ "complete"; "extended" by the effects found, so that the residual is noise; or "unexplained"."""
    effects: list[dict[str, Any]]
    """Effects found, as dicts: kind, parameters, standard_errors, gap_closed, evidence, runner_up, and, if there are any, alike: names of the effects
    that the run cannot distinguish from it."""
    markers: dict[str, Any] | None
    """Distances between disks and markers under the tensions that the gratings show, as a dict: noise_mm, calibration_error_mm, before, after. None
    if there are too few markers to estimate their noise."""
    tried: list[dict[str, Any]]
    """Candidates that improve the model but are not sufficient, best first, as dicts: kind, parameters, evidence, reason."""
    kept: str | None
    """Reason for which the file keeps a μ that contradicts the run: the shapes would be worse otherwise. None if it keeps none."""
    unexplained: dict[str, Any] | None
    """Residual that no effect explains, as a dict: rms_n, rms_mm, where, goes_with. None if there is none."""

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
    """Result of `fit`. The keys of the dicts, such as "bending_stiffness_n_m2", state the unit."""

    manipulator: Manipulator
    """Manipulator with the fitted values. All else, including comments, is as in the given one."""
    parameters: dict[str, float]
    """Fitted values."""
    standard_errors: dict[str, float]
    """Standard errors of the fitted values."""
    given: dict[str, float]
    """Values of the given manipulator."""
    undetermined: list[dict[str, Any]]
    """Parameters that the runs cannot determine, as dicts: parameters (the first keeps its given value), sentence."""
    before: dict[str, float]
    """Errors of the given manipulator, as a dict: tension_rms_n, marker_mean_mm, marker_max_mm. A key is absent if there is nothing to compare."""
    after: dict[str, float]
    """Errors of the fitted manipulator, with the same keys."""
    is_misfit: bool
    """Whether more is left than noise and errors of the gratings' lines, so that something else is missing or wrong."""
    misfit_of: list[str]
    """Signals of which more is left: "gratings", "markers"."""
    common_steps: list[list[dict[str, Any]]]
    """Steps of all gratings together that were taken off, for each run, as dicts: kind, time_s, step_nm."""

    @classmethod
    def _of(cls, shown: Shown, manipulator: Manipulator) -> TendonFit:
        found = json.loads(shown.json)
        keys = ("parameters", "standard_errors", "given", "undetermined", "before", "after", "is_misfit", "misfit_of", "common_steps")
        return cls(shown, manipulator, **{key: found[key] for key in keys})


@dataclass(frozen=True, eq=False, repr=False)
class TendonTrack(Value):
    """Result of `track`. Arrays have one row for each friction model in `ways` and one column for each goal."""

    ways: list[str]
    """Friction models of the commands: "none", "coulomb", "history"."""
    wanted_tip_m: NDArray[np.float64]
    """Wanted positions of the tip, base frame, m, (N, 2)."""
    tip_m: NDArray[np.float64]
    """Positions of the simulated manipulator's tip, base frame, m, (ways, N, 2)."""
    error_m: NDArray[np.float64]
    """Distance of the tip from the goal, m, (ways, N)."""
    along_m: NDArray[np.float64]
    """Distance beyond the goal along the curve on which a single pull moves the tip, m, (ways, N). No tension corrects the rest of the distance."""
    bend_rad: NDArray[np.float64]
    """Bend of the simulated manipulator, rad, (ways, N)."""
    base_tension_n: NDArray[np.float64]
    """Tension at the base, N, (ways, N)."""
    status: NDArray[np.uint32]
    """Bits of `GoalStatus`, (ways, N)."""
