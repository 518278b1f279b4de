"""Many machines, many logs, over years: an operation on all of them, and what has changed since when.

Needs `pip install dask distributed fsspec pyarrow ruptures`: Dask for the workers, fsspec for addresses, pyarrow for results, ruptures for change points.

>>> import datetime, random
>>> import fric
>>> import pyarrow
>>> random.seed(1)
>>> day = datetime.datetime(2026, 1, 1, tzinfo=datetime.timezone.utc)
>>> row = {"robot": "rig", "cable": "cable1", "parameter": "mu", "standard_error": 0.0002}
>>> values = [0.02 + 0.004 * (k >= 20) + random.gauss(0, 0.0003) for k in range(40)]
>>> rows = [{**row, "start": day + datetime.timedelta(weeks=k), "value": value} for k, value in enumerate(values)]
>>> found = fric.fleet.trend(pyarrow.Table.from_pylist(rows))
>>> [(alarm.cable, alarm.parameters, alarm.changes[0].kind, alarm.date.date().isoformat()) for alarm in found.alarms]
[('cable1', ('mu',), 'step', '2026-05-21')]
"""

from ._errors import FleetError
from ._run import FleetRun, LogFailure, run
from ._trend import Alarm, Change, NamedEffect, Series, Trend, trend

__all__ = ["Alarm", "Change", "FleetError", "FleetRun", "LogFailure", "NamedEffect", "Series", "Trend", "run", "trend"]

for _name in __all__:
    globals()[_name].__module__ = "fric.fleet"
