"""The libraries of the extra `fleet`, imported where they are used."""

from importlib import import_module
from typing import Any

# What the extra `fleet` of pyproject.toml names. fric is on no index, so that an extra is of use in a clone only.
LIBRARIES = "dask distributed fsspec pyarrow ruptures"


def need(module: str) -> Any:
    """A module of the extra; ImportError with what to install where it is missing."""
    try:
        return import_module(module)
    except ImportError as error:
        library = module.partition(".")[0]
        raise ImportError(f"fric.fleet needs {library}; install what fleets need with `pip install {LIBRARIES}`") from error
