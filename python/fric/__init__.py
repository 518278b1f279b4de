"""Friction compensation for cable-driven robots: from the force that the winch feels to the force on the platform.

>>> import fric
>>> robot = fric.Robot.read("examples/mini-ipanema.toml")
>>> result = fric.replay(robot, "examples/mini-ipanema.mcap")
>>> [round(error.rms_n, 4) for error in (result.cable("cable1").before, result.cable("cable1").after)]
[0.4314, 0.0171]

Numbers are SI, with the unit in the name, as in the robot file. Whatever is wrong raises a FricError. `fric.plot` draws
(needs matplotlib: `pip install fric[plot]`).
"""

from . import plot
from ._errors import ConfigError, FricError, LogError, LogWarning, OutputError, ShapeError
from ._fric import (
    Cable,
    CableErrors,
    Compensation,
    Compensator,
    ForceError,
    Friction,
    Log,
    LogPaths,
    Monitor,
    Platform,
    ReplayResult,
    Robot,
    Snapshot,
    WrenchError,
    __version__,
    read_log,
    replay,
    simulate,
)
from ._status import Status

__all__ = [
    "Cable",
    "CableErrors",
    "Compensation",
    "Compensator",
    "ConfigError",
    "ForceError",
    "FricError",
    "Friction",
    "Log",
    "LogError",
    "LogPaths",
    "LogWarning",
    "Monitor",
    "OutputError",
    "Platform",
    "ReplayResult",
    "Robot",
    "ShapeError",
    "Snapshot",
    "Status",
    "WrenchError",
    "__version__",
    "plot",
    "read_log",
    "replay",
    "simulate",
]
