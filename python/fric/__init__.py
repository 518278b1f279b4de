"""Friction compensation for cable-driven robots: from the force that the winch feels to the force on the platform.

>>> import fric
>>> robot = fric.Robot.read("examples/mini-ipanema.toml")
>>> result = fric.replay(robot, "examples/mini-ipanema.mcap")
>>> [round(error.rms_n, 4) for error in (result.cable("cable1").before, result.cable("cable1").after)]
[0.4314, 0.0171]

Numbers are SI, with the unit in the name, as in the robot file. Whatever is wrong raises a FricError. `fric.plot` draws
(needs matplotlib: `pip install fric[plot]`).
"""

from . import continuum, plot
from ._errors import ConfigError, FitError, FricError, LogError, LogWarning, OutputError, ShapeError
from ._fric import (
    AxisHysteresis,
    Cable,
    CableDiscovery,
    CableErrors,
    CableFit,
    Compensation,
    Compensator,
    DiscoverResult,
    FitResult,
    ForceError,
    Friction,
    HysteresisResult,
    Log,
    LogPaths,
    Monitor,
    Platform,
    ReplayResult,
    ResidualFunction,
    Robot,
    Snapshot,
    Width,
    WrenchError,
    __version__,
    discover,
    fit,
    hysteresis,
    read_log,
    replay,
    residual_function,
    simulate,
)
from ._status import Status

__all__ = [
    "AxisHysteresis",
    "Cable",
    "CableDiscovery",
    "CableErrors",
    "CableFit",
    "Compensation",
    "Compensator",
    "ConfigError",
    "DiscoverResult",
    "FitError",
    "FitResult",
    "ForceError",
    "FricError",
    "Friction",
    "HysteresisResult",
    "Log",
    "LogError",
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
    "fit",
    "hysteresis",
    "plot",
    "read_log",
    "replay",
    "residual_function",
    "simulate",
]
