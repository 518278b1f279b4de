"""Results: values computed by the compiled part, which can be compared, copied, pickled, and shown."""

from .continuum import (
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
from .discover import CableDiscovery, DiscoverResult
from .excite import ExciteResult
from .fit import CableFit, FitResult
from .hysteresis import AxisHysteresis, HysteresisResult, Width
from .replay import CableErrors, Compensation, ComputedPoses, ForceError, ReplayResult, WrenchError

__all__ = [
    "AxisHysteresis",
    "CableDiscovery",
    "CableErrors",
    "CableFit",
    "CalibrationResult",
    "Command",
    "Compensation",
    "ComputedPoses",
    "DiscoverResult",
    "ExciteResult",
    "FitResult",
    "ForceError",
    "FrictionResult",
    "HoleResult",
    "HysteresisResult",
    "ReplayResult",
    "Shape",
    "ShapeResult",
    "SimulatedTendon",
    "TendonDiscovery",
    "TendonFit",
    "TendonTrack",
    "Width",
    "WrenchError",
]
