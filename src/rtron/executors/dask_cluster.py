"""Runs items on a Dask cluster; Dask comes with the extra `cluster`, and only when asked for."""

from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from importlib import import_module
from socket import create_connection
from typing import Any
from urllib.parse import urlsplit

from rtron import __version__
from rtron.errors import InputError, SourceError
from rtron.executors.base import Item, ItemFailure, Result, run_item
from rtron.executors.chunked_map import CHUNK_SIZE, LostWorkerError, map_in_order

_SCHEMES = frozenset({"tcp", "tls"})
_MAX_SHOWN = 80
_WORKERS_HELP = "install this version of rtron where the workers run, and start them again"


@dataclass(frozen=True, slots=True)
class DaskExecutor:
    """An Executor on the workers of a Dask scheduler, `tcp://host:8786`.

    What workers send is unpickled: whoever rules the cluster can run code here, and the other way
    round. `timeout_s` bounds the wait for the scheduler and for its first worker.
    """

    address: str
    chunk_size: int = CHUNK_SIZE
    timeout_s: float = 10.0

    def map(
        self, function: Callable[[Item], Result], items: Iterable[Item]
    ) -> Iterator[Result | ItemFailure]:
        """Yield each item's result, as Executor says.

        Raise InputError without Dask or for what is no address, SourceError where the cluster does
        not answer, has no workers, or its workers have another rtron.
        """
        with self._workers() as workers:
            yield from map_in_order(workers, function, items, self.chunk_size)

    def map_unordered(
        self, function: Callable[[Item], Result], items: Iterable[Item]
    ) -> Iterator[tuple[Item, Result | ItemFailure]]:
        """Yield each item with its result as soon as there is one; raise what `map` raises."""
        with self._workers() as workers:
            yield from workers.as_completed(function, items)

    @contextmanager
    def _workers(self) -> "Iterator[_DaskWorkers]":
        dask = _import_dask()
        if not _is_address(self.address):
            help = "write it as the scheduler does, tcp://host:8786"
            raise InputError(f"{self.address[:_MAX_SHOWN]!r} is no cluster's address", help=help)
        with self._client(dask) as client:
            yield _DaskWorkers(dask, client, sum(client.nthreads().values()))

    @contextmanager
    def _client(self, dask: Any) -> Iterator[Any]:  # noqa: ANN401 - Dask has no types here
        try:
            _await_scheduler(self.address, self.timeout_s)
            client = dask.Client(self.address, timeout=self.timeout_s, set_as_default=False)
        except (OSError, UnicodeError):
            help = "start one with `dask scheduler` and `dask worker`, or check the address"
            raise SourceError(f"no cluster answers at {self.address}", help=help) from None
        with client:
            self._check_workers(dask, client)
            yield client

    def _check_workers(self, dask: Any, client: Any) -> None:  # noqa: ANN401 - Dask has no types here
        try:
            client.wait_for_workers(1, timeout=self.timeout_s)
        except (TimeoutError, dask.TimeoutError):
            help = f"dask worker {self.address}"
            raise SourceError(f"the cluster at {self.address} has no workers", help=help) from None
        try:
            versions = set(client.run(installed_version).values())
        except ImportError:
            raise SourceError("the cluster's workers have no rtron", help=_WORKERS_HELP) from None
        others = versions - {__version__}
        if others:
            found_versions = f"the cluster's workers have rtron {', '.join(sorted(others))}"
            raise SourceError(f"{found_versions}, not {__version__}", help=_WORKERS_HELP)


@dataclass(frozen=True, slots=True)
class _DaskWorkers:
    """The workers of a cluster."""

    dask: Any
    client: Any
    count: int

    def submit(self, function: Callable[..., Any], *arguments: object) -> Callable[[], Any]:
        """Begin a call on one of them; the answer waits for its result."""
        with self._translate_errors():
            future = self.client.submit(function, *arguments, pure=False)
        return lambda: self._result(future)

    def as_completed(
        self, function: Callable[[Item], Result], items: Iterable[Item]
    ) -> Iterator[tuple[Item, Result | ItemFailure]]:
        """Yield each item with its result, those of lost workers as failed."""
        with self._translate_errors():
            futures = {
                self.client.submit(run_item, function, item, pure=False): item for item in items
            }
        for future in self.dask.as_completed(futures, loop=self.client.loop):
            yield futures[future], self._result_or_failure(future)

    def _result_or_failure(self, future: Any) -> Any:  # noqa: ANN401 - Dask has no types here
        try:
            return self._result(future)
        except LostWorkerError:
            return ItemFailure("the process that worked on it ended")

    def _result(self, future: Any) -> Any:  # noqa: ANN401 - Dask has no types here
        with self._translate_errors():
            return future.result()

    @contextmanager
    def _translate_errors(self) -> Iterator[None]:
        """Tell Dask's faults as ours; the function's own are results."""
        try:
            yield
        except self.dask.KilledWorker:
            raise LostWorkerError from None
        except Exception as error:  # noqa: BLE001 - Dask tells its own faults in many ways
            message = f"the cluster failed: {type(error).__name__}: {error}"
            raise SourceError(message, help="the scheduler's and workers' logs say more") from None


def installed_version() -> str:
    """Return the version of rtron where this runs."""
    return __version__


def _is_address(address: str) -> bool:
    try:
        parts = urlsplit(address)
        return parts.scheme in _SCHEMES and bool(parts.hostname and parts.port)
    except ValueError:
        return False


def _await_scheduler(address: str, timeout_s: float) -> None:
    """Wait until a scheduler greets, as it does first; raise OSError if it does not.

    Dask's own client waits for the greeting without end. With TLS it is the client who begins.
    """
    parts = urlsplit(address)
    with create_connection((parts.hostname, parts.port or 0), timeout=timeout_s) as peer:
        if parts.scheme == "tcp" and not peer.recv(1):
            raise ConnectionError


def _import_dask() -> Any:  # noqa: ANN401 - Dask has no types here
    try:
        return import_module("distributed")
    except ImportError:
        help = 'pip install "rtron[cluster]"'
        raise InputError("--cluster needs Dask", help=help) from None
