"""Tendons through disks: gratings, friction and shape of continuum manipulators.

>>> arm = continuum.Manipulator.read("examples/tendon-prototype.toml")
>>> tendon = continuum.simulate(arm, run="mixed", seed=5)
>>> calibrated = continuum.calibrate(arm, tendon.load_n, tendon.load_shift_nm).manipulator
>>> result = continuum.shape(calibrated, tendon.run, mixed=True, shapes=4)
>>> mean_mm = {way["way"]: way["picked"]["mean_mm"] for way in result.errors}
>>> 5 * mean_mm["history"] < mean_mm["coulomb"]
True

Friction is positive where the base side of a hole is tighter. Holes count from the base plate, disks from the base.
"""

from ._fric import Manipulator, StaticModel, StaticSnapshot, TendonRun
from ._fric import continuum_calibrate as calibrate
from ._fric import continuum_discover as discover
from ._fric import continuum_fit as fit
from ._fric import continuum_friction as friction
from ._fric import continuum_hole as hole
from ._fric import continuum_read_loads as read_loads
from ._fric import continuum_read_run as read_run
from ._fric import continuum_shape as shape
from ._fric import continuum_simulate as simulate
from ._fric import continuum_track as track
from ._results import (
    CalibrationResult,
    Command,
    FrictionResult,
    HoleResult,
    Shape,
    ShapeResult,
    SimulatedTendon,
    TendonDiscovery,
    TendonFit,
    TendonTrack,
)
from ._status import GoalStatus, ShapeStatus

__all__ = [
    "CalibrationResult",
    "Command",
    "FrictionResult",
    "GoalStatus",
    "HoleResult",
    "Manipulator",
    "Shape",
    "ShapeResult",
    "ShapeStatus",
    "SimulatedTendon",
    "StaticModel",
    "StaticSnapshot",
    "TendonDiscovery",
    "TendonFit",
    "TendonRun",
    "TendonTrack",
    "calibrate",
    "discover",
    "fit",
    "friction",
    "hole",
    "read_loads",
    "read_run",
    "shape",
    "simulate",
    "track",
]

for _name in __all__:
    if getattr(globals()[_name], "__module__", "").startswith("fric._results"):
        globals()[_name].__module__ = "fric.continuum"
