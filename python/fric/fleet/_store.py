"""Results as a Parquet data set with one file per log, which is either complete or absent.

`operation=fit/robot=NAME/month=2026-03/HASH-KEY.parquet`: HASH is that of the log's bytes, KEY that of everything else on which the numbers depend
(version of fric, operation, options, model). The same work has the same name, so that repeating it changes nothing. `_seen` records the bytes of each
log by the state in which it was listed. Without it, logs are read once more to see that nothing is missing.
"""

from __future__ import annotations

import hashlib
import io
import json
import os
import time
import uuid
from collections.abc import Mapping
from typing import Any
from urllib.parse import quote

from .._errors import ConfigError, OutputError
from ._logs import LogAddress, file_system, is_local
from ._needs import need

FAILED = "-failed"
"""End of the name of a file that holds an error."""
# Stores in which an object is either complete or absent. Elsewhere, a file is written beside its place and then renamed.
_OBJECT_STORES = {"s3", "s3a", "gs", "gcs", "abfs", "az", "memory"}
_SEEN = "_seen"
# After an interruption, a run reads again at most the logs that were finished in this time, or this number of logs.
_FLUSH_S = 5.0
_FLUSH_COUNT = 5000


def key_of(version: str, operation: str, options: Mapping[str, Any], model_hash: str | None) -> str:
    """Returns the hash of everything on which results depend except the log. `model_hash` is None if each log has its own model."""
    text = json.dumps([version, operation, dict(options), model_hash], sort_keys=True, default=list)
    return hashlib.sha256(text.encode()).hexdigest()[:16]


def schema() -> Any:
    """Returns the columns of a result, with one row per log, cable, and parameter."""
    pa = need("pyarrow")
    text, number = pa.string(), pa.float64()
    return pa.schema(
        [
            ("log", text),
            ("log_hash", text),
            ("start", pa.timestamp("ns", tz="UTC")),
            ("duration_s", number),
            ("cable", text),
            ("parameter", text),
            ("value", number),
            ("standard_error", number),
            ("state", text),
            ("verdict", text),
            ("warnings", pa.list_(text)),
            ("error", text),
            ("fric_version", text),
            ("model_hash", text),
            ("options", text),
            ("seconds", number),
            ("computed", pa.timestamp("us", tz="UTC")),
        ]
    )


class Store:
    """Data set of results."""

    def __init__(self, address: str | os.PathLike[str]) -> None:
        self.address = os.fspath(address)
        self._fs, self._root = file_system(self.address)
        self._root = self._root.rstrip("/")
        self._pending: list[str] = []
        self._flushed_s = time.monotonic()

    def path(self, operation: str, robot: str | None, month: str | None, log_hash: str, key: str) -> str:
        """Returns the path of the result of a log."""
        parts = {"operation": operation, "robot": robot or "unknown", "month": month or "unknown"}
        folders = "/".join(f"{name}={quote(value, safe=' ')}" for name, value in parts.items())
        return f"{self._root}/{folders}/{log_hash}-{key}.parquet"

    def written(self, path: str) -> bool:
        """Returns whether there is a result at a path."""
        return bool(self._fs.exists(path))

    def error_of(self, path: str) -> str | None:
        """Returns the sentence of the error that is stored instead of a result; None if there is none."""
        failed = _of_error(path)
        return self.error_at(failed)[1] if self._fs.exists(failed) else None

    def error_at(self, path: str) -> tuple[str, str]:
        """Returns the log and the sentence of an error that was written."""
        sheet = io.BytesIO(self._fs.cat_file(path))
        [row] = need("pyarrow.parquet").read_table(sheet, columns=["log", "error"]).to_pylist()
        return row["log"], row["error"]

    def write(self, path: str, rows: list[dict[str, Any]], *, failed: bool = False) -> None:
        """Writes the rows of a log, either completely or not at all."""
        columns = schema()
        sheet = io.BytesIO()
        need("pyarrow.parquet").write_table(need("pyarrow").Table.from_pylist(rows, schema=columns), sheet, compression="zstd")
        self._put(_of_error(path) if failed else path, sheet.getvalue())

    def names(self) -> dict[str, str]:
        """Returns the paths of all results by their names without extension. The names of errors end in `FAILED`."""
        if not self._fs.exists(self._root):
            return {}
        # The folder may be cached from an earlier listing, and this or another process may have changed it since.
        self._fs.invalidate_cache()
        paths = (path for path in self._fs.find(self._root) if path.endswith(".parquet"))
        named = ((path, path.rpartition("/")[2]) for path in paths)
        return {name.removesuffix(".parquet"): path for path, name in named if not name.startswith((".", "_"))}

    def seen(self) -> dict[str, str]:
        """Returns the hashes of logs by the stamps with which they were listed."""
        folder = f"{self._root}/{_SEEN}"
        if not self._fs.exists(folder):
            return {}
        lines = (line for file in self._fs.find(folder) if file.endswith(".txt") for line in self._fs.cat_file(file).decode().split("\n"))
        pairs = (line.split(" ") for line in lines)
        return {pair[0]: pair[1] for pair in pairs if len(pair) == 2}

    def remember(self, log: LogAddress, log_hash: str) -> None:
        """Records the bytes of a log; `flush` stores the record."""
        self._pending.append(f"{log.stamp} {log_hash}")
        if len(self._pending) >= _FLUSH_COUNT or time.monotonic() - self._flushed_s > _FLUSH_S:
            self.flush()

    def flush(self) -> None:
        """Writes what was recorded."""
        if self._pending:
            self._put(f"{self._root}/{_SEEN}/{uuid.uuid4().hex}.txt", "\n".join(self._pending).encode())
        self._pending, self._flushed_s = [], time.monotonic()

    def table(self) -> Any:
        """Returns all rows as a `pyarrow.Table`, with `operation`, `robot`, and `month`."""
        pa, dataset = need("pyarrow"), need("pyarrow.dataset")
        parts = pa.schema([(name, pa.string()) for name in ("operation", "robot", "month")])
        paths = sorted(self.names().values())
        if not paths:
            raise ConfigError(f"{self.address} has no results; fric.fleet.run writes them")
        hive = dataset.partitioning(parts, flavor="hive")
        every = pa.unify_schemas([schema(), parts])
        try:
            return dataset.dataset(paths, schema=every, filesystem=self._fs, partitioning=hive, partition_base_dir=self._root).to_table()
        except (pa.ArrowInvalid, OSError) as error:
            broken = [path for path in paths if not self._is_whole(path)]
            if not broken:
                raise
            more = f" and {len(broken) - 1} more" if len(broken) > 1 else ""
            text = f"the result {broken[0]}{more} is damaged; delete it and run again, which computes its log anew"
            raise OutputError(text) from error

    def _is_whole(self, path: str) -> bool:
        pa = need("pyarrow")
        try:
            need("pyarrow.parquet").read_table(io.BytesIO(self._fs.cat_file(path)))
        except (pa.ArrowInvalid, OSError):
            return False
        return True

    def _put(self, path: str, content: bytes) -> None:
        folder, _, name = path.rpartition("/")
        try:
            if _OBJECT_STORES.intersection([self._fs.protocol] if isinstance(self._fs.protocol, str) else self._fs.protocol):
                self._fs.pipe_file(path, content)
                return
            self._fs.makedirs(folder, exist_ok=True)
            beside = f"{folder}/.{name}.{uuid.uuid4().hex}.part"
            if is_local(self._fs):
                with open(beside, "wb") as stream:
                    stream.write(content)
                    stream.flush()
                    os.fsync(stream.fileno())
                os.replace(beside, path)
            else:
                self._fs.pipe_file(beside, content)
                self._fs.mv(beside, path)
        except OSError as error:
            raise OutputError(f"the result {path} cannot be written: {error}; nothing of it was") from error


def _of_error(path: str) -> str:
    return f"{path.removesuffix('.parquet')}{FAILED}.parquet"
