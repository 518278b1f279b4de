"""What the cluster can fail with."""

from .._errors import FricError


class FleetError(FricError):
    """No cluster can be reached, or it cannot do the work; says which and what to do. Results that were written stay."""
