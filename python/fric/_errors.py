"""What fric raises and warns of."""


class FricError(Exception):
    """Anything that fric refuses or cannot do."""


class ConfigError(FricError, ValueError):
    """A robot file, a parameter or an option is not right; says which, its value and what is allowed."""


class ShapeError(FricError, ValueError):
    """An array is not of the shape, type or content that is needed; says what was expected and what came."""


class ArrayTypeError(ShapeError, TypeError):
    """What was given for an array is none of numbers; says what was expected and what came."""


class LogError(FricError):
    """A log cannot be read, or lacks what is needed."""


class FitError(FricError):
    """Data allow no fit; says what is missing and what to do."""


class OutputError(FricError, OSError):
    """A file cannot be written: it exists, is an input, or the disk says no. Nothing was written."""


class _Missing(FileNotFoundError):
    """Its text is the sentence alone; `filename` is the file."""

    def __str__(self) -> str:
        return self.strerror or super().__str__()


class ConfigFileNotFoundError(_Missing, ConfigError):
    """A robot or manipulator file is not there; `filename` says which."""


class LogFileNotFoundError(_Missing, LogError):
    """A log is not there; `filename` says which."""


class LogWarning(UserWarning):
    """Something in a log is worth knowing: damage, gaps, flags, a signal that is missing."""


for _public in (
    FricError,
    ConfigError,
    ConfigFileNotFoundError,
    ShapeError,
    ArrayTypeError,
    LogError,
    LogFileNotFoundError,
    FitError,
    OutputError,
    LogWarning,
):
    _public.__module__ = "fric"
