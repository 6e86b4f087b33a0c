"""A survey: the apps of a folder that have no result yet are scanned, several at a time."""

import subprocess
import sys
from collections.abc import Generator, Iterator, Sequence
from concurrent.futures import Future, ThreadPoolExecutor, as_completed
from contextlib import closing, suppress
from dataclasses import dataclass, field
from pathlib import Path
from time import monotonic
from typing import IO, cast

from rtron.errors import InputError, SourceError
from rtron.functions.reading.skipped_entries import SkippedEntry
from rtron.sources.static.common.scan_options import Progress, default_workers
from rtron.survey.app_listing import REQUEST_ADAPTER, AppToScan, ScanRequest, find_apps
from rtron.survey.app_survey import RESULT_ADAPTER, AppResult
from rtron.survey.results_file import ResultsFile, results_file

DEFAULT_SECONDS = 120.0


@dataclass(frozen=True, slots=True, kw_only=True)
class SurveyOptions:
    """Where a survey works and for how long: `seconds` bound each app.

    `jobs` processes scan side by side, by default one a core. Without `use_cache` nothing of
    earlier runs counts, and nothing is kept.
    """

    seconds: float = DEFAULT_SECONDS
    jobs: int | None = None
    use_cache: bool = True


@dataclass(frozen=True, slots=True, kw_only=True)
class Survey:
    """The results in the order of the apps, and the launch files that are no apps.

    `reused` results are from earlier runs. One that a person ended has no results for `missing`
    apps. It took `seconds`.
    """

    results: Sequence[AppResult]
    left_out: Sequence[SkippedEntry] = ()
    reused: int = 0
    missing: int = 0
    seconds: float = 0.0

    def failures(self) -> Iterator[SkippedEntry]:
        """Yield the apps that could not be scanned, with the reasons."""
        for result in self.results:
            if result.survey is None:
                yield SkippedEntry(location=result.app, reason=result.error)


def run_survey(folder: Path, options: SurveyOptions, progress: Progress) -> Survey:
    """Return the survey of the apps below a folder; Ctrl-C ends it with the results that it has.

    Raise InputError for a folder that cannot be read or without apps.
    """
    started, left_out = monotonic(), list[SkippedEntry]()
    apps = list(find_apps(folder, left_out.append, progress))
    if not apps:
        help = "rtron scan DIR lists the launch files and the arguments that they need"
        raise InputError("no app can be scanned", path=str(folder), help=help)
    store = results_file(folder) if options.use_cache else ResultsFile(None)
    results = dict(store.read(apps, options.seconds))
    reused = len(results)
    is_whole = _scan_missing(apps, options, store, results, progress)
    if is_whole:
        store.compact(apps, options.seconds)
    return Survey(
        results=[results[app.name] for app in apps if app.name in results],
        left_out=left_out,
        reused=reused,
        missing=len(apps) - len(results),
        seconds=monotonic() - started,
    )


def _scan_missing(
    apps: Sequence[AppToScan],
    options: SurveyOptions,
    store: ResultsFile,
    results: dict[str, AppResult],
    progress: Progress,
) -> bool:
    """Scan the apps without a result and add theirs; tell whether all were, not ended before."""
    missing = [app for app in apps if app.name not in results]
    progress(len(results), len(apps), "")
    failed = sum(not result.survey for result in results.values())
    try:
        with closing(_scan(missing, options)) as scanned:
            for app, result in scanned:
                store.add(app, result, options.seconds)
                results[app.name] = result
                failed += not result.survey
                progress(len(results), len(apps), f"{failed} failed, {app.name}")
    except KeyboardInterrupt:
        return False
    return True


def _scan(
    apps: Sequence[AppToScan], options: SurveyOptions
) -> Generator[tuple[AppToScan, AppResult], None, None]:
    requests = [
        ScanRequest(app=app, seconds=options.seconds, use_cache=options.use_cache) for app in apps
    ]
    if not requests:
        return
    cores = default_workers()
    pool = ThreadPoolExecutor(min(options.jobs or cores, cores, len(requests)))
    with closing(ScanServers()) as servers:
        try:
            futures = {pool.submit(servers.scan, request): request for request in requests}
            for future in as_completed(futures):
                yield futures[future].app, _result(futures[future], future)
        finally:
            pool.shutdown(wait=False, cancel_futures=True)


def _result(request: ScanRequest, future: "Future[AppResult]") -> AppResult:
    try:
        return future.result()
    except Exception as error:  # noqa: BLE001 - one app must not end the others
        reason = str(error)
    return AppResult(
        app=request.app.name,
        repository=request.app.repository_name,
        ros=request.app.ros,
        seconds=0.0,
        error=reason,
        is_final=False,
    )


_COMMAND = (sys.executable, "-m", "rtron.survey.scan_server")


class _ScanServer:
    """A process that scans; a session of its own keeps a terminal's Ctrl-C from it."""

    def __init__(self) -> None:
        self._process = subprocess.Popen(  # noqa: S603 - our own command
            _COMMAND,
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.DEVNULL,
            start_new_session=True,
        )
        self._requests = cast("IO[bytes]", self._process.stdin)
        self._answers = cast("IO[bytes]", self._process.stdout)

    def scan(self, request: ScanRequest) -> AppResult:
        """Return what became of an app; raise SourceError if the process has ended."""
        with suppress(BrokenPipeError):  # then there is no answer
            self._requests.write(REQUEST_ADAPTER.dump_json(request) + b"\n")
            self._requests.flush()
        answer = self._answers.readline()
        if not answer.endswith(b"\n"):
            raise SourceError("the process that scans apps ended")
        return RESULT_ADAPTER.validate_json(answer)

    def end(self) -> None:
        """End the process and the scan that it is at."""
        with suppress(BrokenPipeError), self._process:  # a request that it never read is left
            self._process.kill()


@dataclass(slots=True)
class ScanServers:
    """As many processes that scan as there are scans at a time; each is started when needed."""

    _idle: list[_ScanServer] = field(default_factory=list)
    _started: list[_ScanServer] = field(default_factory=list)

    def scan(self, request: ScanRequest) -> AppResult:
        """Return what became of an app; raise SourceError if the process that scans it ended."""
        try:
            server = self._idle.pop()
        except IndexError:
            server = _ScanServer()
            self._started.append(server)
        result = server.scan(request)
        self._idle.append(server)
        return result

    def close(self) -> None:
        """End all processes, and with them the scans that are under way."""
        for server in self._started:
            server.end()
