"""Friction compensation for cable-driven robots: from the force that the winch feels to the force on the platform.

>>> import fric
>>> robot = fric.Robot.read("examples/mini-ipanema.toml")
>>> result = fric.replay(robot, "examples/mini-ipanema.mcap")
>>> [round(error.rms_n, 4) for error in (result.cable("cable1").before, result.cable("cable1").after)]
[0.4314, 0.0171]

Numbers are SI, with the unit in the name, as in the robot file. Whatever is wrong raises a FricError. `fric.plot` draws
(needs matplotlib: `pip install matplotlib`), `fric.fleet` works on many logs (needs `pip install dask distributed fsspec pyarrow ruptures`).
"""

# Runs before the other imports, which would fail in a sub-interpreter with less clear messages.
from ._interpreter import refuse_sub_interpreters as _refuse_sub_interpreters

_refuse_sub_interpreters()

from . import continuum, fleet, plot  # noqa: E402
from ._errors import (  # noqa: E402
    ArgumentTypeError,
    ArrayTypeError,
    ConfigError,
    ConfigFileNotFoundError,
    FitError,
    FricError,
    InUseError,
    LogError,
    LogFileNotFoundError,
    LogWarning,
    OutputError,
    ShapeError,
)
from ._fric import (  # noqa: E402
    Cable,
    Compensator,
    Friction,
    Log,
    LogPaths,
    Monitor,
    Platform,
    ResidualFunction,
    Robot,
    Snapshot,
    __version__,
    discover,
    excite,
    fit,
    hysteresis,
    read_log,
    replay,
    residual_function,
    simulate,
)
from ._results import (  # noqa: E402
    AxisHysteresis,
    CableDiscovery,
    CableErrors,
    CableFit,
    Compensation,
    ComputedPoses,
    DiscoverResult,
    ExciteResult,
    FitResult,
    ForceError,
    HysteresisResult,
    ReplayResult,
    Width,
    WrenchError,
)
from ._status import Status  # noqa: E402

__all__ = [
    "ArgumentTypeError",
    "ArrayTypeError",
    "AxisHysteresis",
    "Cable",
    "CableDiscovery",
    "CableErrors",
    "CableFit",
    "Compensation",
    "ComputedPoses",
    "Compensator",
    "ConfigError",
    "ConfigFileNotFoundError",
    "DiscoverResult",
    "ExciteResult",
    "FitError",
    "FitResult",
    "ForceError",
    "FricError",
    "Friction",
    "HysteresisResult",
    "InUseError",
    "Log",
    "LogError",
    "LogFileNotFoundError",
    "LogPaths",
    "LogWarning",
    "Monitor",
    "OutputError",
    "Platform",
    "ReplayResult",
    "ResidualFunction",
    "Robot",
    "ShapeError",
    "Snapshot",
    "Status",
    "Width",
    "WrenchError",
    "__version__",
    "continuum",
    "discover",
    "excite",
    "fit",
    "fleet",
    "hysteresis",
    "plot",
    "read_log",
    "replay",
    "residual_function",
    "simulate",
]

# Results report the package as their module, not the file in which they are defined.
for _name in __all__:
    if getattr(globals()[_name], "__module__", "").startswith("fric._results"):
        globals()[_name].__module__ = "fric"
