"""Many machines, many logs, over years: an operation on all of them, and what has changed since when.

>>> import fric
>>> fric.fleet.run("fits", "logs/*.mcap", results="results")
Traceback (most recent call last):
    ...
fric.ConfigError: there is no operation `fits`; did you mean `fit`? Known are discover, fit, replay
"""

from ._errors import FleetError
from ._run import FleetRun, LogFailure, run

__all__ = ["FleetError", "FleetRun", "LogFailure", "run"]

for _name in __all__:
    globals()[_name].__module__ = "fric.fleet"
