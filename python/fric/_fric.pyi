from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from os import PathLike
from typing import Any, Final, Literal, final, overload

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ._results import (
    CalibrationResult,
    Command,
    Compensation,
    DiscoverResult,
    ExciteResult,
    FitResult,
    FrictionResult,
    HoleResult,
    HysteresisResult,
    ReplayResult,
    Shape,
    ShapeResult,
    SimulatedTendon,
    TendonDiscovery,
    TendonFit,
    TendonTrack,
)

__all__ = [
    "CATALOGUE",
    "Cable",
    "Compensator",
    "Friction",
    "GOAL_STATUS_BITS",
    "Log",
    "LogPaths",
    "Manipulator",
    "Monitor",
    "Platform",
    "ResidualFunction",
    "Robot",
    "SHAPE_STATUS_BITS",
    "STATUS_BITS",
    "_command_line",
    "_unknown_name",
    "Snapshot",
    "StaticModel",
    "StaticSnapshot",
    "TendonRun",
    "__version__",
    "continuum_calibrate",
    "continuum_discover",
    "continuum_fit",
    "continuum_friction",
    "continuum_hole",
    "continuum_read_loads",
    "continuum_read_run",
    "continuum_shape",
    "continuum_simulate",
    "continuum_track",
    "discover",
    "excite",
    "fit",
    "hysteresis",
    "read_log",
    "replay",
    "residual_function",
    "simulate",
]

GOAL_STATUS_BITS: Final[dict[str, int]]
SHAPE_STATUS_BITS: Final[dict[str, int]]
CATALOGUE: Final[list[dict[str, Any]]]
STATUS_BITS: Final[dict[str, int]]
__version__: Final[str]

_Path = str | PathLike[str]
_Vector = Sequence[float] | NDArray[Any]
_Progress = bool | Callable[[float], object] | None
_GoalWay = Literal["history", "none", "pulling", "releasing"]
_Way = Literal["history", "none", "pulling", "releasing", "measured"]

@final
class Platform:
    mass_kg: float
    @property
    def center_of_mass_m(self) -> tuple[float, float, float]: ...
    @center_of_mass_m.setter
    def center_of_mass_m(self, value: _Vector) -> None: ...
    @property
    def inertia_kg_m2(self) -> tuple[float, float, float, float, float, float]: ...
    @inertia_kg_m2.setter
    def inertia_kg_m2(self, value: _Vector) -> None: ...
    @property
    def gravity_m_per_s2(self) -> tuple[float, float, float]: ...
    @gravity_m_per_s2.setter
    def gravity_m_per_s2(self, value: _Vector) -> None: ...
    def set(self, **values: Any) -> None: ...
    def __eq__(self, other: object, /) -> bool: ...
    def __copy__(self, /) -> Platform: ...
    def _repr_html_(self) -> str: ...

@final
class Monitor:
    frozen_cycles: int | None
    length_jump_m: float | None
    length_noise_m: float | None
    sensor_jump_n: float | None
    def set(self, **values: Any) -> None: ...
    def __eq__(self, other: object, /) -> bool: ...
    def __copy__(self, /) -> Monitor: ...
    def _repr_html_(self) -> str: ...

@final
class LogPaths:
    cable: str
    length: str | None
    speed: str | None
    @property
    def reference(self) -> str | Mapping[str, float]: ...
    @reference.setter
    def reference(self, value: str | Mapping[str, float]) -> None: ...
    pose: str
    wrench: str
    @property
    def columns(self) -> Mapping[str, Mapping[str, Any]] | None: ...
    @columns.setter
    def columns(self, value: Mapping[str, Mapping[str, Any]] | None) -> None: ...
    def set(self, **values: Any) -> None: ...
    def __eq__(self, other: object, /) -> bool: ...
    def __copy__(self, /) -> LogPaths: ...
    def _repr_html_(self) -> str: ...

@final
class Friction:
    mu: float
    sigma_n_per_m: float | None
    viscous_n_s_per_m: float
    offset_n: float
    def set(self, **values: Any) -> None: ...
    def __eq__(self, other: object, /) -> bool: ...
    def __copy__(self, /) -> Friction: ...
    def _repr_html_(self) -> str: ...

@final
class Cable:
    name: str
    presliding: Literal["per_pulley", "lumped"]
    traction_mu: float | None
    @property
    def base_m(self) -> tuple[float, float, float] | None: ...
    @base_m.setter
    def base_m(self, value: _Vector | None) -> None: ...
    @property
    def platform_m(self) -> tuple[float, float, float] | None: ...
    @platform_m.setter
    def platform_m(self, value: _Vector | None) -> None: ...
    @property
    def pulleys(self) -> tuple[Mapping[str, Any], ...]: ...
    @pulleys.setter
    def pulleys(self, value: Iterable[Mapping[str, Any]]) -> None: ...
    @property
    def validated(self) -> Mapping[str, Any] | None: ...
    @validated.setter
    def validated(self, value: Mapping[str, Any] | None) -> None: ...
    @property
    def effects(self) -> tuple[Mapping[str, Any], ...]: ...
    @effects.setter
    def effects(self, value: Iterable[Mapping[str, Any]]) -> None: ...
    @property
    def friction(self) -> Friction: ...
    @friction.setter
    def friction(self, value: Mapping[str, Any]) -> None: ...
    def set(self, **values: Any) -> None: ...
    def __eq__(self, other: object, /) -> bool: ...
    def __copy__(self, /) -> Cable: ...
    def _repr_html_(self) -> str: ...

@final
class Robot:
    name: str
    cycle_s: float
    @staticmethod
    def read(path: _Path) -> Robot: ...
    @staticmethod
    def from_toml(text: str) -> Robot: ...
    def to_toml(self) -> str: ...
    def write(self, path: _Path, *, force: bool = False) -> None: ...
    @property
    def cable_names(self) -> tuple[str, ...]: ...
    @property
    def cables(self) -> tuple[Cable, ...]: ...
    @property
    def platform(self) -> Platform: ...
    @platform.setter
    def platform(self, value: Mapping[str, Any]) -> None: ...
    @property
    def monitor(self) -> Monitor: ...
    @monitor.setter
    def monitor(self, value: Mapping[str, Any]) -> None: ...
    @property
    def log(self) -> LogPaths: ...
    @log.setter
    def log(self, value: Mapping[str, Any]) -> None: ...
    def cable(self, name: str) -> Cable: ...
    def set(self, **values: Any) -> None: ...
    def _repr_html_(self) -> str: ...
    def __eq__(self, other: object, /) -> bool: ...

@final
class Snapshot:
    def __eq__(self, other: object, /) -> bool: ...

@final
class Compensator:
    def __new__(cls, robot: Robot) -> Compensator: ...
    def step(
        self,
        sensor_force_n: ArrayLike,
        length_m: ArrayLike,
        speed_m_per_s: ArrayLike,
        *,
        position_m: ArrayLike | None = None,
        orientation_xyzw: ArrayLike | None = None,
        elapsed_cycles: float = 1.0,
    ) -> Compensation: ...
    def run(
        self,
        sensor_force_n: ArrayLike,
        length_m: ArrayLike,
        speed_m_per_s: ArrayLike,
        *,
        position_m: ArrayLike | None = None,
        orientation_xyzw: ArrayLike | None = None,
        elapsed_cycles: ArrayLike = 1.0,
        progress: _Progress = False,
    ) -> Compensation: ...
    def reset(self) -> None: ...
    def snapshot(self) -> Snapshot: ...
    def restore(self, snapshot: Snapshot) -> None: ...
    def pulley_friction_n(self, cable: str) -> NDArray[np.float64]: ...
    def __eq__(self, other: object, /) -> bool: ...

@final
class Log:
    @staticmethod
    def from_arrays(
        *,
        cable_names: Sequence[str],
        stamp_nanos: ArrayLike,
        sensor_force_n: ArrayLike,
        length_m: ArrayLike,
        speed_m_per_s: ArrayLike | None = None,
        reference_force_n: ArrayLike | None = None,
        position_m: ArrayLike | None = None,
        orientation_xyzw: ArrayLike | None = None,
        outside_force_n: ArrayLike | None = None,
        outside_torque_nm: ArrayLike | None = None,
    ) -> Log: ...
    @property
    def stamp_nanos(self) -> NDArray[np.int64]: ...
    @property
    def time_s(self) -> NDArray[np.float64]: ...
    @property
    def sensor_force_n(self) -> NDArray[np.float64]: ...
    @property
    def length_m(self) -> NDArray[np.float64]: ...
    @property
    def speed_m_per_s(self) -> NDArray[np.float64]: ...
    @property
    def reference_force_n(self) -> NDArray[np.float64]: ...
    @property
    def position_m(self) -> NDArray[np.float64]: ...
    @property
    def orientation_xyzw(self) -> NDArray[np.float64]: ...
    @property
    def outside_force_n(self) -> NDArray[np.float64]: ...
    @property
    def outside_torque_nm(self) -> NDArray[np.float64]: ...
    @property
    def robot(self) -> Robot | None: ...
    @property
    def cable_names(self) -> tuple[str, ...]: ...
    def to_polars(self) -> Any: ...
    def to_pandas(self) -> Any: ...
    def _repr_html_(self) -> str: ...
    def __len__(self) -> int: ...
    @overload
    def __getitem__(self, key: slice, /) -> Log: ...
    @overload
    def __getitem__(self, key: str, /) -> NDArray[np.float64]: ...
    def __contains__(self, name: str, /) -> bool: ...
    def __iter__(self) -> Iterator[str]: ...
    def __eq__(self, other: object, /) -> bool: ...

@final
class ResidualFunction:
    @property
    def names(self) -> tuple[str, ...]: ...
    @property
    def x0(self) -> NDArray[np.float64]: ...
    @property
    def bounds(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]: ...
    @property
    def rows(self) -> NDArray[np.int64]: ...
    def lmfit_parameters(self) -> Any: ...
    def __call__(self, x: Any) -> NDArray[np.float64]: ...
    def jac(self, x: Any) -> NDArray[np.float64]: ...
    def __len__(self) -> int: ...
    def __eq__(self, other: object, /) -> bool: ...

def discover(
    robot: Robot,
    log: Log | _Path | Sequence[Log | _Path],
    *,
    reference: Literal["forces", "wrench"] = "forces",
    per_log: Sequence[str] | None = None,
    empirical: bool = True,
    progress: _Progress = False,
) -> DiscoverResult: ...
def fit(
    robot: Robot,
    log: Log | _Path | Sequence[Log | _Path],
    *,
    reference: Literal["forces", "wrench"] = "forces",
    parameters: Sequence[str] | None = None,
    per_log: Sequence[str] | None = None,
    huber: bool = False,
    progress: _Progress = False,
) -> FitResult: ...
def residual_function(
    robot: Robot,
    log: Log | _Path | Sequence[Log | _Path],
    cable: str,
    *,
    parameters: Sequence[str] | None = None,
    progress: _Progress = False,
) -> ResidualFunction: ...
def excite(
    robot: Robot,
    *,
    box_m: Sequence[Sequence[float]] | None = None,
    max_speed_m_per_s: float | None = None,
    max_acceleration_m_per_s2: float | None = None,
    min_tension_n: float | None = None,
    max_tension_n: float | None = None,
    for_: DiscoverResult | dict[str, Any] | str | None = None,
    separate: Sequence[str] | None = None,
    determine: Sequence[str] | None = None,
    duration_s: float | None = None,
    cables: Sequence[str] | None = None,
    noise_n: float | None = None,
    output: _Path | None = None,
    force: bool = False,
    progress: _Progress = False,
) -> ExciteResult: ...
def hysteresis(
    robot: Robot, log: Log | _Path | Sequence[_Path], *, progress: _Progress = False
) -> HysteresisResult: ...
def read_log(paths: _Path | Sequence[_Path], robot: Robot | None = None, *, progress: _Progress = False) -> Log: ...
def replay(
    robot: Robot,
    log: Log | _Path | Sequence[_Path],
    *,
    output: _Path | None = None,
    force: bool = False,
    correct: bool = False,
    progress: _Progress = False,
) -> ReplayResult: ...
def simulate(
    robot: Robot,
    *,
    run: Literal["identification", "crossing"] = "identification",
    seed: int = 0,
    duration_s: float | None = None,
    effects: Iterable[str | Mapping[str, Any]] = (),
    disturbances: Iterable[str | Mapping[str, Any]] = (),
    sensor_noise_n: float = 0.02,
    reference_noise_n: float = 0.01,
    mu_spread_ratio: float = 0.0,
    sensor_wander_n: float = 0.0,
    reference_wander_n: float = 0.0,
    wander_s: float = 2.0,
    hand_n: float = 0.0,
    length_noise_m: float = 0.0,
    length_resolution_m: float = 0.0,
    progress: _Progress = False,
) -> Log: ...

@final
class Manipulator:
    @staticmethod
    def read(path: _Path) -> Manipulator: ...
    @staticmethod
    def from_toml(text: str) -> Manipulator: ...
    def to_toml(self) -> str: ...
    def write(self, path: _Path, *, force: bool = False) -> None: ...
    @property
    def name(self) -> str: ...
    @property
    def disk_count(self) -> int: ...
    @property
    def mu(self) -> NDArray[np.float64]: ...
    @property
    def has_gratings(self) -> bool: ...
    def __eq__(self, other: object, /) -> bool: ...

@final
class TendonRun:
    @staticmethod
    def from_arrays(
        manipulator: Manipulator,
        *,
        time_s: Any,
        tension_base_n: Any = None,
        shift_nm: Any = None,
        shift_reference_nm: Any = None,
        marker_m: Any = None,
    ) -> TendonRun: ...
    @property
    def time_s(self) -> NDArray[np.float64]: ...
    @property
    def tension_base_n(self) -> NDArray[np.float64] | None: ...
    @property
    def shift_nm(self) -> NDArray[np.float64] | None: ...
    @property
    def shift_reference_nm(self) -> NDArray[np.float64] | None: ...
    @property
    def marker_m(self) -> NDArray[np.float64] | None: ...
    def __len__(self) -> int: ...
    def __eq__(self, other: object, /) -> bool: ...

@final
class StaticSnapshot:
    def __eq__(self, other: object, /) -> bool: ...

@final
class StaticModel:
    def __new__(
        cls,
        manipulator: Manipulator,
        *,
        least_tension_n: _Vector = (0.0, 0.0),
        greatest_tension_n: _Vector | None = None,
        hold_rad: float = 0.0,
    ) -> StaticModel: ...
    def solve(
        self, base_tension_n: ArrayLike, *, friction: _Way = "history", tension_n: ArrayLike | None = None
    ) -> Shape: ...
    def run(
        self,
        base_tension_n: ArrayLike,
        *,
        friction: _Way = "history",
        tension_n: ArrayLike | None = None,
        progress: _Progress = False,
    ) -> Shape: ...
    def tension_for(
        self,
        *,
        bend_rad: ArrayLike | None = None,
        tip_m: ArrayLike | None = None,
        friction: _GoalWay = "history",
    ) -> Command: ...
    def follow(
        self,
        *,
        bend_rad: ArrayLike | None = None,
        tip_m: ArrayLike | None = None,
        friction: _GoalWay = "history",
        progress: _Progress = False,
    ) -> Command: ...
    def reset(self) -> None: ...
    def snapshot(self) -> StaticSnapshot: ...
    def restore(self, snapshot: StaticSnapshot) -> None: ...
    @property
    def manipulator(self) -> Manipulator: ...
    def __eq__(self, other: object, /) -> bool: ...

def continuum_calibrate(manipulator: Manipulator, load_n: Any, shift_nm: Any) -> CalibrationResult: ...
def continuum_discover(manipulator: Manipulator, run: TendonRun) -> TendonDiscovery: ...
def continuum_fit(
    manipulator: Manipulator,
    runs: TendonRun | Sequence[TendonRun],
    *,
    parameters: Sequence[str] | None = None,
) -> TendonFit: ...
def continuum_friction(manipulator: Manipulator, run: TendonRun) -> FrictionResult: ...
def continuum_hole(tension_1_n: Any, tension_2_n: Any, angle_1_rad: Any, angle_2_rad: Any) -> HoleResult: ...
def continuum_read_loads(
    path: _Path, manipulator: Manipulator
) -> tuple[NDArray[np.float64], NDArray[np.float64]]: ...
def continuum_read_run(path: _Path, manipulator: Manipulator) -> TendonRun: ...
def continuum_shape(
    manipulator: Manipulator,
    run: TendonRun,
    *,
    shapes: int = 6,
    at_s: Sequence[float] | None = None,
    mixed: bool = False,
    ways: Sequence[Literal["none", "coulomb", "measured", "history"]] | None = None,
) -> ShapeResult: ...
def continuum_simulate(
    manipulator: Manipulator,
    *,
    run: Literal["one_way", "mixed"] = "one_way",
    seed: int = 0,
    greatest_tension_n: float = 1.7,
    mu_spread_ratio: float = 0.1,
    grating_noise_nm: float = 0.0005,
    marker_noise_m: float = 0.00025,
) -> SimulatedTendon: ...
def continuum_track(
    manipulator: Manipulator,
    *,
    bend_rad: ArrayLike | None = None,
    tip_m: ArrayLike | None = None,
    seed: int = 0,
    mu_spread_ratio: float = 0.1,
) -> TendonTrack: ...
def _command_line(words: Sequence[str]) -> int: ...
def _unknown_name(what: str, name: str, known: Sequence[str]) -> str: ...
