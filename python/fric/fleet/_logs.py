"""Logs from globs and addresses: the list of logs, their hashes, and a file on this machine for each."""

from __future__ import annotations

import hashlib
import os
import tempfile
from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from .._arguments import must_be
from .._errors import ConfigError, LogFileNotFoundError
from ._needs import need

# File that marks a folder as a rosbag2 bag.
_BAG = "metadata.yaml"
_BLOCK_BYTES = 1 << 20
_NO_ENTRY = 2
_PATHS = "a path or a list of paths"


@dataclass(frozen=True)
class LogAddress:
    """Address of a log, and its state when it was listed."""

    address: str
    """Path on this machine, or address with its protocol."""
    stamp: str
    """Hash of the address, the size, and the date of change or checksum, as the file system lists them. The content is not read for it."""


def find(paths: str | os.PathLike[str] | Sequence[str | os.PathLike[str]], results: str) -> list[LogAddress]:
    """Returns all logs that paths, globs, and fsspec addresses name, each once, ordered by address.

    A folder named by itself is a log (a bag). Among the matches of a glob, logs are files and folders with a `metadata.yaml`, without those in the
    folder of the results. Raises LogFileNotFoundError for a path that matches nothing.
    """
    path = (str, os.PathLike)
    must_be("paths", paths, _PATHS, *path, Iterable)
    asked = [paths] if isinstance(paths, path) else list(paths)
    if not asked:
        raise ConfigError("`paths` is empty; give at least one path, glob or address of logs")
    found: dict[str, LogAddress] = {}
    for one in asked:
        must_be("paths", one, _PATHS, *path)
        found.update((log.address, log) for log in _matches(os.fspath(one)))
    inside = f"{results.rstrip('/')}/"
    return [found[address] for address in sorted(found) if not address.startswith(inside)]


@contextmanager
def fetched(address: str) -> Iterator[Path]:
    """Provides the log as a file or folder on this machine. A copy from elsewhere is removed afterwards."""
    fs, path = file_system(address)
    if is_local(fs):
        yield Path(path)
        return
    with tempfile.TemporaryDirectory(prefix="fric-fleet-") as place:
        target = Path(place) / path.rstrip("/").rpartition("/")[2]
        fs.get(path, str(target), recursive=fs.isdir(path))
        yield target


def content_hash(path: Path) -> str:
    """Returns the SHA-256 of the bytes of a log; for a folder, of the names and bytes of all its files."""
    digest = hashlib.sha256()
    files = sorted(one for one in path.rglob("*") if one.is_file()) if path.is_dir() else [path]
    for file in files:
        if file != path:
            digest.update(f"{file.relative_to(path).as_posix()}\0{file.stat().st_size}\0".encode())
        with file.open("rb") as stream:
            while block := stream.read(_BLOCK_BYTES):
                digest.update(block)
    return digest.hexdigest()


def file_system(address: str) -> tuple[Any, str]:
    """Returns the fsspec file system of an address, and the path in it."""
    fsspec = need("fsspec")
    try:
        fs, path = fsspec.core.url_to_fs(address)
    except ImportError as error:
        raise ImportError(f"{address} cannot be reached: {error}; install that package on every worker too") from error
    except ValueError as error:
        raise ConfigError(f"{address} cannot be reached: {error}; fsspec lists the protocols that it knows") from error
    return fs, str(path)


def is_local(fs: Any) -> bool:
    """Returns whether a file system is that of this machine."""
    return isinstance(fs, need("fsspec.implementations.local").LocalFileSystem)


def _matches(path: str) -> Iterator[LogAddress]:
    fs, inner = file_system(path)
    # A file name itself may contain brackets or stars.
    if fs.exists(inner):
        yield _listed(fs, inner, fs.info(inner))
        return
    entries: dict[str, dict[str, Any]] = fs.glob(inner, detail=True) if need("fsspec.core").has_magic(inner) else {}
    folders = [name for name, info in entries.items() if info["type"] == "directory"]
    bags = [name for name in folders if fs.exists(f"{name.rstrip('/')}/{_BAG}")]
    inside = tuple(f"{bag.rstrip('/')}/" for bag in bags)
    logs = {name: info for name, info in entries.items() if name in bags or info["type"] != "directory"}
    logs = {name: info for name, info in logs.items() if not name.startswith(inside)}
    if not logs:
        raise LogFileNotFoundError(_NO_ENTRY, f"no log matches {path}; name a log, a glob such as logs/*.mcap or an address", path)
    for name, info in logs.items():
        yield _listed(fs, name, info)


def _listed(fs: Any, name: str, info: dict[str, Any]) -> LogAddress:
    address = name if is_local(fs) else str(fs.unstrip_protocol(name))
    parts: Iterable[Any] = [info]
    if info["type"] == "directory":
        parts = sorted(fs.find(name, detail=True).items())
    digest = hashlib.sha256(address.encode())
    for part in parts:
        digest.update(str(part).encode())
    return LogAddress(address, digest.hexdigest()[:32])
