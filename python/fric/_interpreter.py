"""Detection of sub-interpreters."""

from importlib import import_module


def refuse_sub_interpreters() -> None:
    """Raises ImportError in any interpreter other than the main one."""
    # The first name exists in Python 3.13 and newer.
    for name in ("_interpreters", "_xxsubinterpreters"):
        try:
            interpreters = import_module(name)
        except ImportError:
            continue
        if interpreters.get_current() != interpreters.get_main():
            raise ImportError(
                "fric does not work in sub-interpreters, nor does NumPy, which it needs; import it in the main interpreter "
                "and use threads or processes (concurrent.futures, joblib)"
            )
        return
