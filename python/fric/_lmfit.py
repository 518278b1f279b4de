"""Residual functions for lmfit."""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from ._fric import ResidualFunction


def parameters(function: ResidualFunction) -> Any:
    """Returns `lmfit.Parameters` with start values and bounds."""
    try:
        lmfit = import_module("lmfit")
    except ImportError as error:
        raise ImportError("lmfit_parameters needs lmfit; install it with `pip install lmfit`") from error
    table = lmfit.Parameters()
    for name, value, least, greatest in zip(function.names, function.x0, *function.bounds):
        table.add(name.replace(".", "_"), value=float(value), min=float(least), max=float(greatest))
    return table
