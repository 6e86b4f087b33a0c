"""Run tests in several processes, which are forked when all tests have been collected.

Each process takes the next file that none has taken: the tests of a file share its fixtures. That
a process neither collects for itself nor is told its tests one by one makes a run of thousands of
short tests take half the processor time that it takes with xdist.
"""

import os
import signal
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import groupby
from multiprocessing import get_context
from multiprocessing.connection import Connection, wait
from multiprocessing.process import BaseProcess
from struct import Struct

import pytest
from _pytest import runner

_PLACE = Struct("I")
_FORK = get_context("fork")


def pytest_addoption(parser):
    """Add the option."""
    parser.addoption("--processes", type=int, default=0, help="run the tests in so many processes")


@pytest.hookimpl(tryfirst=True)
def pytest_runtestloop(session):
    """Run the tests in processes, if the option says so."""
    options = session.config.option
    if options.processes < 2 or options.collectonly or session.testsfailed:
        return None
    _Run(session).run()
    return True


@dataclass
class _Worker:
    """A process, and what it has not yet reported of the file that it runs."""

    reports: Connection
    process: BaseProcess
    end: int
    """Readable when the process has ended, whatever it has forked."""
    rest: list[pytest.Item]
    last: pytest.Item


class _Run:
    """All tests of a session, on their way through its processes."""

    def __init__(self, session: pytest.Session) -> None:
        self._session = session
        session.config._tmp_path_factory.getbasetemp()  # one for all
        files = groupby(session.items, key=lambda item: item.path)
        self._files = [list(items) for _, items in files]
        self._next_files, feed = os.pipe()
        # so few bytes fit into the pipe, and it ends where the files do
        os.write(feed, b"".join(map(_PLACE.pack, range(len(self._files)))))
        os.close(feed)
        self._workers: list[_Worker] = []

    def run(self) -> None:
        """Run them; raise what pytest raises where it is to stop."""
        try:
            for _ in range(min(self._session.config.option.processes, len(self._files))):
                self._start([])
            while self._workers:
                wait([end for each in self._workers for end in (each.reports, each.end)])
                for worker in list(self._workers):
                    self._read(worker)
        finally:
            for worker in self._workers:
                signal.pidfd_send_signal(worker.end, signal.SIGINT)
            for worker in self._workers:
                worker.process.join()
            os.close(self._next_files)

    def _start(self, first: list[pytest.Item]) -> None:
        reader, writer = _FORK.Pipe(duplex=False)
        process = _FORK.Process(target=self._work, args=(writer, first))
        process.start()
        writer.close()
        end = os.pidfd_open(process.pid)
        self._workers.append(_Worker(reader, process, end, first, self._session.items[-1]))

    def _read(self, worker: _Worker) -> None:
        """Hand pytest what a worker has reported; start another where it has died."""
        is_running = worker.process.is_alive()
        try:
            while worker.reports.poll():
                self._take(worker, worker.reports.recv())
        except EOFError:
            worker.process.join()
            is_running = False
        if not is_running:
            self._end(worker)

    def _take(self, worker: _Worker, message: int | list[pytest.TestReport]) -> None:
        if isinstance(message, int):
            worker.rest = list(self._files[message])
            return
        worker.last = worker.rest.pop(0)
        self._log(message)

    def _log(self, reports: list[pytest.TestReport]) -> None:
        hook = self._session.config.hook
        whose = {"nodeid": reports[0].nodeid, "location": reports[0].location}
        hook.pytest_runtest_logstart(**whose)
        for report in reports:
            hook.pytest_runtest_logreport(report=report)
        hook.pytest_runtest_logfinish(**whose)
        if self._session.shouldfail:
            raise self._session.Failed(self._session.shouldfail)
        if self._session.shouldstop:
            raise self._session.Interrupted(self._session.shouldstop)

    def _end(self, worker: _Worker) -> None:
        self._workers.remove(worker)
        worker.reports.close()
        os.close(worker.end)
        code = worker.process.exitcode
        if worker.rest or code:
            item, *rest = worker.rest or [worker.last]
            self._log([_died(item, code)])
            if rest:
                self._start(rest)

    def _work(self, reports: Connection, first: list[pytest.Item]) -> None:
        """Run files of tests in this process, which is the workers', until none is left."""
        for each in self._workers:
            each.reports.close()
        plugins = self._session.config.pluginmanager
        capture = plugins.getplugin("capturemanager")
        capture.stop_global_capturing()  # it has the files of the process that forked this one
        capture.start_global_capturing()
        plugins.register(_Reporting(reports))
        try:
            _run_items(first)
            for place in self._places():
                reports.send(place)
                _run_items(self._files[place])
        except KeyboardInterrupt:
            signal.signal(signal.SIGINT, signal.SIG_IGN)
        finally:
            capture.stop_global_capturing()
            runner.pytest_sessionfinish(self._session)
            if measuring := plugins.getplugin("_cov"):
                measuring.cov_controller.cov.stop()
                measuring.cov_controller.cov.save()

    def _places(self) -> Iterator[int]:
        while place := os.read(self._next_files, _PLACE.size):
            yield _PLACE.unpack(place)[0]


class _Reporting:
    """Sends what becomes of each test, instead of logging it in a process that nobody reads."""

    def __init__(self, reports: Connection) -> None:
        self._reports = reports

    @pytest.hookimpl(tryfirst=True)
    def pytest_runtest_protocol(self, item, nextitem):
        self._reports.send(runner.runtestprotocol(item, log=False, nextitem=nextitem))
        return True


def _run_items(items: list[pytest.Item]) -> None:
    """Run the tests of a file; what outlives a file is kept for the next one."""
    for place, item in enumerate(items, 1):
        nextitem = items[place] if place < len(items) else item.session
        item.config.hook.pytest_runtest_protocol(item=item, nextitem=nextitem)


def _died(item: pytest.Item, code: int | None) -> pytest.TestReport:
    why = f"the process of the test has ended with code {code}"
    return pytest.TestReport(item.nodeid, item.location, {}, "failed", why, "call")
