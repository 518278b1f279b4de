"""Exceptions and warnings of fric."""

import re


class FricError(Exception):
    """Base class of all errors of fric. Two of one class with the same text are equal, as a pickled one is to its copy."""

    def __eq__(self, other: object) -> bool:
        return self is other or (type(self) is type(other) and str(self) == str(other))

    def __hash__(self) -> int:
        return hash((type(self), str(self)))


class ConfigError(FricError, ValueError):
    """A robot file, a parameter, or an option is invalid. The message states which one, its value, and what is allowed."""


class ShapeError(FricError, ValueError):
    """An array has the wrong shape, type, or content. The message states what was expected and what was given."""


class ArrayTypeError(ShapeError, TypeError):
    """An array argument is not an array of numbers. The message states what was expected and what was given."""


class ArgumentTypeError(ConfigError, TypeError):
    """An argument is not of the class or range that the call takes. The message states which argument, what it must be, and what was given."""

    def add_note(self, note: str) -> None:
        """Takes the name of the argument into the message. The compiled part gives it as a note."""
        if name := re.fullmatch("while processing '(.*)'", note):
            self.args = (f"`{name[1]}` {self}",)
        else:
            super().add_note(note)


class InUseError(FricError, RuntimeError):
    """An object is used by two calls at once. The message states what to do."""


class LogError(FricError):
    """A log cannot be read or lacks required data."""


class FitError(FricError):
    """The data do not allow a fit. The message states what is missing and what to do."""


class OutputError(FricError, OSError):
    """A file cannot be written, because it exists, is an input, or the disk refuses. Nothing was written."""


class _Missing(FileNotFoundError):
    """Error of a missing file. Its text is only the sentence; `filename` is the file."""

    def __str__(self) -> str:
        return self.strerror or super().__str__()


class ConfigFileNotFoundError(_Missing, ConfigError):
    """A robot or manipulator file does not exist; `filename` states which."""


class LogFileNotFoundError(_Missing, LogError):
    """A log does not exist; `filename` states which."""


class LogWarning(UserWarning):
    """A log has a property worth knowing: damage, gaps, flags, or a missing signal."""


for _public in (
    FricError,
    ConfigError,
    ConfigFileNotFoundError,
    ShapeError,
    ArrayTypeError,
    ArgumentTypeError,
    InUseError,
    LogError,
    LogFileNotFoundError,
    FitError,
    OutputError,
    LogWarning,
):
    _public.__module__ = "fric"
