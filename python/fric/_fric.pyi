from collections.abc import Callable, Iterable, Mapping, Sequence
from os import PathLike
from typing import Any, Final, Literal, TypedDict, final

import numpy as np
from numpy.typing import ArrayLike, NDArray

__all__ = [
    "AxisHysteresis",
    "Cable",
    "CableDiscovery",
    "CableErrors",
    "CableFit",
    "Compensation",
    "Compensator",
    "DiscoverResult",
    "FitResult",
    "ForceError",
    "Friction",
    "HysteresisResult",
    "Log",
    "LogPaths",
    "Monitor",
    "Platform",
    "ReplayResult",
    "ResidualFunction",
    "Robot",
    "STATUS_BITS",
    "Snapshot",
    "Width",
    "WrenchError",
    "__version__",
    "discover",
    "fit",
    "hysteresis",
    "read_log",
    "replay",
    "residual_function",
    "simulate",
]

STATUS_BITS: Final[dict[str, int]]
__version__: Final[str]

_Path = str | PathLike[str]
_Vector = Sequence[float] | NDArray[Any]
_Progress = bool | Callable[[float], object] | None

@final
class Platform:
    mass_kg: float
    @property
    def center_of_mass_m(self) -> tuple[float, float, float]: ...
    @center_of_mass_m.setter
    def center_of_mass_m(self, value: _Vector) -> None: ...
    @property
    def gravity_m_per_s2(self) -> tuple[float, float, float]: ...
    @gravity_m_per_s2.setter
    def gravity_m_per_s2(self, value: _Vector) -> None: ...
    def set(self, **values: Any) -> None: ...

@final
class Monitor:
    frozen_cycles: int | None
    length_jump_m: float | None
    length_noise_m: float | None
    def set(self, **values: Any) -> None: ...

@final
class LogPaths:
    cable: str
    length: str | None
    speed: str | None
    reference: str
    pose: str
    wrench: str
    def set(self, **values: Any) -> None: ...

@final
class Friction:
    mu: float
    sigma_n_per_m: float | None
    viscous_n_s_per_m: float
    offset_n: float
    def set(self, **values: Any) -> None: ...

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
    def __eq__(self, other: object, /) -> bool: ...

@final
class Snapshot: ...

@final
class Compensation:
    @property
    def force_at_platform_n(self) -> NDArray[np.float64]: ...
    @property
    def friction_n(self) -> NDArray[np.float64]: ...
    @property
    def frictionless_n(self) -> NDArray[np.float64]: ...
    @property
    def status(self) -> NDArray[np.uint32]: ...
    @property
    def outside_wrench(self) -> NDArray[np.float64] | None: ...

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
    def __len__(self) -> int: ...

@final
class ForceError:
    @property
    def rms_n(self) -> float: ...
    @property
    def mae_n(self) -> float: ...

@final
class WrenchError:
    @property
    def force_rms_n(self) -> float: ...
    @property
    def torque_rms_nm(self) -> float: ...

@final
class CableErrors:
    @property
    def name(self) -> str: ...
    @property
    def samples(self) -> int: ...
    @property
    def flagged(self) -> int: ...
    @property
    def flags(self) -> int: ...
    @property
    def before(self) -> ForceError | None: ...
    @property
    def after(self) -> ForceError | None: ...

@final
class ReplayResult:
    @property
    def robot(self) -> str: ...
    @property
    def cables(self) -> tuple[CableErrors, ...]: ...
    @property
    def wrench(self) -> tuple[WrenchError, WrenchError] | None: ...
    @property
    def force_at_platform_n(self) -> NDArray[np.float64]: ...
    @property
    def friction_n(self) -> NDArray[np.float64]: ...
    @property
    def frictionless_n(self) -> NDArray[np.float64]: ...
    @property
    def status(self) -> NDArray[np.uint32]: ...
    @property
    def outside_wrench(self) -> NDArray[np.float64] | None: ...
    def cable(self, name: str) -> CableErrors: ...

@final
class CableFit:
    @property
    def name(self) -> str: ...
    @property
    def samples(self) -> int: ...
    @property
    def left_out(self) -> dict[str, int]: ...
    @property
    def termination(self) -> str: ...
    @property
    def evaluations(self) -> int: ...
    @property
    def values(self) -> dict[str, float]: ...
    @property
    def standard_errors(self) -> dict[str, float]: ...
    @property
    def undetermined(self) -> list[str]: ...
    @property
    def parameters(self) -> tuple[str, ...]: ...
    @property
    def covariance(self) -> NDArray[np.float64]: ...
    @property
    def residuals_n(self) -> NDArray[np.float64]: ...
    @property
    def before(self) -> ForceError | None: ...
    @property
    def after(self) -> ForceError | None: ...

@final
class FitResult:
    @property
    def robot(self) -> Robot: ...
    @property
    def reference(self) -> Literal["forces", "wrench", "mass"]: ...
    @property
    def cables(self) -> tuple[CableFit, ...]: ...
    @property
    def wrench(self) -> tuple[WrenchError, WrenchError] | None: ...
    def cable(self, name: str) -> CableFit: ...
    def summary(self) -> str: ...
    def to_json(self) -> str: ...
    def to_dict(self) -> dict[str, Any]: ...

class _LeftOut(TypedDict):
    flagged: int
    without_reference: int
    warm_up: int
    outliers: int

class _Missing(TypedDict):
    cause: str
    advice: str

# `from` is a keyword, so that its declaration is no class.
_Where = TypedDict(
    "_Where",
    {
        "signal": str,
        "from": float,
        "to": float,
        "unit": str,
        "share_of_excess": float | None,
        "share_of_samples": float | None,
        "explains": float | None,
        "significance": float | None,
        "intervals_s": list[list[float]],
    },
)

class _Evidence(TypedDict):
    delta_bic: float | None
    held_out_rms_n: float | None

class _Candidate(_Evidence):
    kind: str

class _RunnerUp(_Candidate):
    as_good: bool

class _Effect(TypedDict):
    kind: str
    parameters: dict[str, float]
    standard_errors: dict[str, float]
    gap_closed: float | None
    evidence: _Evidence
    runner_up: _RunnerUp | None

class _Fault(TypedDict):
    fault: Literal["frozen", "clipped"]
    from_s: float
    to_s: float

_Unexplained = TypedDict(
    "_Unexplained",
    {
        "rms_n": float | None,
        "frequency_hz": list[float],
        "amplitude_n": list[float],
        "faults": list[_Fault],
        "where": list[_Where],
        "intervals_s": list[list[float]],
        "goes_with": list[str],
    },
)

class _CommonParameter(TypedDict):
    key: str
    unit: str
    mean: float
    standard_error: float
    differs: bool
    least: float
    greatest: float

class _CommonEffect(TypedDict):
    kind: str
    cables: list[str]
    parameters: list[_CommonParameter]

@final
class CableDiscovery:
    @property
    def name(self) -> str: ...
    @property
    def samples(self) -> int: ...
    @property
    def left_out(self) -> _LeftOut: ...
    @property
    def held_out_samples(self) -> list[list[int]]: ...
    @property
    def held_out_s(self) -> list[list[float]]: ...
    @property
    def noise_floor_n(self) -> float | None: ...
    @property
    def wander_n(self) -> float | None: ...
    @property
    def before(self) -> ForceError | None: ...
    @property
    def after(self) -> ForceError | None: ...
    @property
    def gap_closed(self) -> float | None: ...
    @property
    def verdict(self) -> Literal["complete", "extended", "unexplained"] | None: ...
    @property
    def missing(self) -> _Missing | None: ...
    @property
    def where(self) -> list[_Where]: ...
    @property
    def where_in_words(self) -> list[str]: ...
    @property
    def effects(self) -> list[_Effect]: ...
    @property
    def candidates(self) -> list[_Candidate]: ...
    @property
    def parameters(self) -> dict[str, float]: ...
    @property
    def standard_errors(self) -> dict[str, float]: ...
    @property
    def unexplained(self) -> _Unexplained | None: ...
    @property
    def time_s(self) -> NDArray[np.float64]: ...
    @property
    def residual_before_n(self) -> NDArray[np.float64]: ...
    @property
    def residual_after_n(self) -> NDArray[np.float64]: ...

@final
class DiscoverResult:
    @property
    def robot(self) -> Robot: ...
    @property
    def cables(self) -> tuple[CableDiscovery, ...]: ...
    @property
    def common_effects(self) -> list[_CommonEffect]: ...
    def cable(self, name: str) -> CableDiscovery: ...
    def plot(self, cable: str) -> Any: ...
    def summary(self) -> str: ...
    def to_json(self) -> str: ...
    def to_dict(self) -> dict[str, Any]: ...

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

@final
class Width:
    @property
    def width(self) -> float: ...
    @property
    def standard_error(self) -> float | None: ...

@final
class AxisHysteresis:
    @property
    def axis(self) -> str: ...
    @property
    def unit(self) -> str: ...
    @property
    def passes(self) -> int: ...
    @property
    def without(self) -> Width | None: ...
    @property
    def compensated(self) -> Width | None: ...
    @property
    def lasting_ratio(self) -> float | None: ...
    @property
    def applied_subtracted(self) -> bool | None: ...

@final
class HysteresisResult:
    @property
    def axes(self) -> tuple[AxisHysteresis, ...]: ...
    @property
    def position_m(self) -> tuple[float, float, float]: ...
    def summary(self) -> str: ...
    def to_json(self) -> str: ...
    def to_dict(self) -> dict[str, Any]: ...

def discover(
    robot: Robot, log: Log | _Path | Sequence[Log | _Path], *, progress: _Progress = False
) -> DiscoverResult: ...
def fit(
    robot: Robot,
    log: Log | _Path | Sequence[Log | _Path],
    *,
    reference: Literal["forces", "wrench"] = "forces",
    parameters: Sequence[str] | None = None,
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
