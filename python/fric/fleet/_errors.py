"""Errors of the cluster."""

from .._errors import FricError


class FleetError(FricError):
    """No cluster can be reached, or it cannot do the work. The message states the cause and the remedy. Results that were written are kept."""
