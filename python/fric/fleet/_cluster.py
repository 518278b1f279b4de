"""Workers: those of a scheduler, or processes of this machine."""

from __future__ import annotations

import logging
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

from .._errors import ConfigError
from ._errors import FleetError
from ._needs import need

_WORKER_WAIT_S = 60.0
_CONNECT_WAIT_S = 10.0


@contextmanager
def connected(client: Any, workers: int | None) -> Iterator[Any]:
    """Provides a `distributed.Client` with at least one worker. All that is started or opened here ends with the context."""
    distributed = need("distributed")
    if client is None:
        with _own(distributed, workers) as own:
            yield own
        return
    if workers is not None:
        raise ConfigError("`workers` is for processes of this machine; a `client` has workers of its own")
    if isinstance(client, str):
        with _at(distributed, client) as there:
            yield _ready(there)
        return
    if not isinstance(client, distributed.Client) or client.asynchronous:
        kind = type(client).__name__
        raise ConfigError(f"`client` is {kind}; give a scheduler's address or a distributed.Client that is not asynchronous")
    yield _ready(client)


@contextmanager
def _own(distributed: Any, workers: int | None) -> Iterator[Any]:
    if workers is not None and workers < 1:
        raise ConfigError(f"`workers` is {workers}; give 1 or more")
    # Each process has one thread: with more, the threads of fric and those of the worker would compete.
    environment = {"RAYON_NUM_THREADS": "1"}
    # Any free port, only reachable from this machine: another cluster may use the default port.
    dashboard = "127.0.0.1:0"
    try:
        cluster = distributed.LocalCluster(
            n_workers=workers,
            threads_per_worker=1,
            processes=True,
            dashboard_address=dashboard,
            silence_logs=logging.CRITICAL,
            env=environment,
        )
    except RuntimeError as error:
        text = f'no workers can be started on this machine: {error}; a script needs `if __name__ == "__main__":` around its call of run'
        raise FleetError(text) from error
    with cluster, distributed.Client(cluster) as client:
        yield client


@contextmanager
def _at(distributed: Any, address: str) -> Iterator[Any]:
    try:
        client = distributed.Client(address, timeout=_CONNECT_WAIT_S)
    except (OSError, ValueError) as error:
        text = f"no scheduler answers at {address}; start one with `dask scheduler`, or leave `client` out for workers of this machine"
        raise FleetError(text) from error
    with client:
        yield client


def _ready(client: Any) -> Any:
    try:
        client.wait_for_workers(1, timeout=_WORKER_WAIT_S)
    except TimeoutError as error:
        address = client.scheduler.address
        text = f"the scheduler at {address} has no worker; start some with `dask worker {address} --nthreads 1`"
        raise FleetError(text) from error
    return client
