"""The libraries of the extra `fleet`, imported where they are used."""

from importlib import import_module
from typing import Any


def need(module: str) -> Any:
    """A module of the extra; ImportError with what to install where it is missing."""
    try:
        return import_module(module)
    except ImportError as error:
        library = module.partition(".")[0]
        raise ImportError(f"fric.fleet needs {library}; install it with `pip install 'fric[fleet]'`") from error
