"""Libraries of the extra `fleet`, imported where they are used."""

from importlib import import_module
from typing import Any

# Libraries of the extra `fleet` of pyproject.toml. fric is on no package index, so that the extra is only usable in a clone.
LIBRARIES = "dask distributed fsspec pyarrow ruptures"


def need(module: str) -> Any:
    """Returns a module of the extra. Raises ImportError with what to install if it is missing."""
    try:
        return import_module(module)
    except ImportError as error:
        library = module.partition(".")[0]
        raise ImportError(f"fric.fleet needs {library}; install what fleets need with `pip install {LIBRARIES}`") from error
