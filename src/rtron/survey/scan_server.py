"""The process that scans one app after the other: `python -m rtron.survey.scan_server`.

Each line of its input is a ScanRequest as JSON, each line of its output an AppResult. It has loaded
what a scan needs, and forks a process for each app: a crash or a timeout costs that app only, and
Python starts once. It ends with its input.
"""

import os
import signal
import sys
from contextlib import suppress
from dataclasses import dataclass
from multiprocessing import get_context
from multiprocessing.connection import Connection, wait
from pathlib import Path
from shlex import quote
from time import monotonic
from typing import IO

import rtron.sources.static.ros1.app  # noqa: F401 - loaded once for all apps, like that of ROS 2
from rtron.errors import RTronError
from rtron.functions.node_functions import with_functions
from rtron.sources.models import ROS2_LIBRARY, load_models
from rtron.sources.models.packages import known_packages
from rtron.sources.static.common.cache import hash_workspace
from rtron.sources.static.common.parent_process import follow_parent
from rtron.sources.static.ros2.app import read_ros2_workspace
from rtron.sources.workspace import Workspace, read_workspace, share_workspaces
from rtron.survey.app_listing import REQUEST_ADAPTER, AppToScan, ScanRequest
from rtron.survey.app_survey import RESULT_ADAPTER, AppResult, AppSurvey, survey_app
from rtron.vocabulary import InteractionGraph, Node
from rtron.workflows.app_selection import AppSelection, select_app
from rtron.workflows.source_app import SourceOptions

_FORK = get_context("fork")
_MAX_ERROR_LENGTH = 300
_ROS2 = 2
_SEVERAL = 3


def main() -> None:
    """Answer each request until there are no more."""
    answers = os.fdopen(os.dup(sys.stdout.fileno()), "wb")
    os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())  # no scan writes among answers
    _load()
    signal.signal(signal.SIGALRM, raise_timeout)
    sharing = WorkspaceSharing()
    for line in sys.stdin.buffer:
        request = REQUEST_ADAPTER.validate_json(line)
        sharing.prepare(request)
        result = scan_forked(request, sys.stdin.buffer)
        answers.write(RESULT_ADAPTER.dump_json(result) + b"\n")
        answers.flush()


def _load() -> None:
    """Load the tables of all rules, classifiers and models once: the forked processes have them."""
    known_packages()
    hash_workspace(Workspace({}))
    load_models()
    load_models(ROS2_LIBRARY)
    node = Node(name="/node", package="package")
    top = Path("/")
    survey_app(
        AppToScan(top=top, repository=top, launch=top / "app.launch"),
        with_functions(InteractionGraph(app="app", nodes=(node,)), {"package": "a robot"}),
    )


@dataclass(slots=True)
class WorkspaceSharing:
    """Shares the workspace of the repository whose apps are scanned now with the forked processes.

    Most apps need where packages lie and a hash of them. Where several follow each other, what the
    build files of all packages say is read once, too.
    """

    _key: tuple[tuple[Path, ...], str] = ((), "")
    _count: int = 0
    _workspace: Workspace | None = None

    def prepare(self, request: ScanRequest) -> None:
        """Read the workspace of an app.

        What cannot be read in time, or at all, each scan reads for itself, and says so.
        """
        key = _folders(request.app), _package_path(request.app)
        if key != self._key:
            share_workspaces()
            self._key, self._count, self._workspace = key, 0, None
        self._count += 1
        with suppress(RTronError, RecursionError, MemoryError, _ReadingTimeoutError):
            signal.setitimer(signal.ITIMER_REAL, request.seconds)
            try:
                self._read(request.app)
            finally:
                signal.setitimer(signal.ITIMER_REAL, 0)

    def _read(self, app: AppToScan) -> None:
        if self._count == 1:
            folders, package_path = self._key
            found: list[tuple[Workspace, str | None]] = [
                (read_workspace(folders, {"ROS_PACKAGE_PATH": package_path}), package_path)
            ]
            if app.ros == _ROS2:
                found.append((read_ros2_workspace(folders), None))
            self._workspace = found[-1][0]
            hash_workspace(self._workspace)
            share_workspaces(*found)
        if self._count == _SEVERAL and self._workspace:
            self._workspace.plugins("")


class _ReadingTimeoutError(BaseException):
    """Raised in the middle of whatever reads a workspace for too long."""


def raise_timeout(*_: object) -> None:
    """End what is being read; the handler of the alarm."""
    raise _ReadingTimeoutError


def _folders(app: AppToScan) -> tuple[Path, ...]:
    return (app.repository, *app.others) if app.ros == _ROS2 else (app.repository,)


def _package_path(app: AppToScan) -> str:
    return ":".join(map(str, app.others))


def scan_forked(request: ScanRequest, requests: IO[bytes]) -> AppResult:
    """Return what becomes of an app that is scanned in a process of its own.

    The next of `requests` comes after the answer: if it is there during the scan, it is their end,
    and ends the scan.
    """
    receiver, sender = _FORK.Pipe(duplex=False)
    process = _FORK.Process(target=_scan, args=(request, sender))
    started = monotonic()
    process.start()
    sender.close()
    try:
        if receiver in wait([receiver, requests.fileno()], request.seconds):
            return RESULT_ADAPTER.validate_json(receiver.recv_bytes())
        return _result(request, started, error=f"not done within {request.seconds:g} s")
    except EOFError:
        process.join()
        reason = f"its process ended with {process.exitcode}"
        return _result(request, started, error=reason, is_final=False)
    finally:
        process.kill()
        process.join()
        receiver.close()


def _scan(request: ScanRequest, sender: Connection) -> None:
    """Scan an app and send what became of it."""
    follow_parent()
    started = monotonic()
    try:
        result = _result(request, started, survey=_survey(request))
    except RTronError as error:
        result = _result(request, started, error=_relative(str(error), request.app.top))
    except RecursionError:
        result = _result(request, started, error="nested too deep")
    except MemoryError:
        result = _result(request, started, error="too large")
    except Exception as error:  # noqa: BLE001 - a fault of ours must not end the survey
        reason = f"RTron failed at it: {type(error).__name__}: {error}"
        result = _result(request, started, error=reason[:_MAX_ERROR_LENGTH])
    sender.send_bytes(RESULT_ADAPTER.dump_json(result))


def _survey(request: ScanRequest) -> AppSurvey:
    app = request.app
    os.environ["ROS_PACKAGE_PATH"] = _package_path(app)
    source = SourceOptions(
        launches=(quote(str(app.launch)),), jobs=1, use_cache=request.use_cache, start_method="fork"
    )
    selection = AppSelection(inputs=tuple(map(str, _folders(app))), live=None, source=source)
    return survey_app(app, select_app(selection).source.read())


def _relative(reason: str, top: Path) -> str:
    return reason.replace(f"{top}/", "")[:_MAX_ERROR_LENGTH]


def _result(
    request: ScanRequest,
    started: float,
    *,
    survey: AppSurvey | None = None,
    error: str = "",
    is_final: bool = True,
) -> AppResult:
    return AppResult(
        app=request.app.name,
        repository=request.app.repository_name,
        ros=request.app.ros,
        seconds=round(monotonic() - started, 3),
        survey=survey,
        error=error,
        is_final=is_final,
    )


if __name__ == "__main__":
    main()
