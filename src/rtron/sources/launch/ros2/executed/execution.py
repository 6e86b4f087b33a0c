"""Runs a launch file's Python with the real launch library, where the user asks for that.

In a process of its own, with a time limit, in the user's own environment; nothing that the launch
file starts is started (`visit`).
"""

import json
import os
import re
import tempfile
from collections import defaultdict
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TypeAlias

from rtron.errors import InputError, SourceError
from rtron.sources.code.workspace_sources import WorkspaceSources
from rtron.sources.launch.ros2.choices import LaunchChoices
from rtron.sources.launch.ros2.evaluator import LaunchEvaluator
from rtron.sources.launch.ros2.executed.python_process import find_pythons, run_with_timeout
from rtron.sources.launch.ros2.executed.report import VisitReport, read_report
from rtron.sources.launch.ros2.executed.report_text import ReportTexts
from rtron.sources.launch.ros2.executed.report_translator import ReportTranslator
from rtron.sources.launch.ros2.reader import absolute_path
from rtron.sources.launch.ros2.result import AppLaunch, LaunchStart
from rtron.sources.launch.ros2.substitutions.template import display_text
from rtron.vocabulary import Evidence, UnknownValue

DEFAULT_TIMEOUT_S = 60.0
_VISIT = Path(__file__).parent / "visit"
_MAX_LOG_BYTES = 400
_NAME = re.compile(r"[A-Za-z0-9][\w.-]{0,200}")


@dataclass(frozen=True, slots=True, kw_only=True)
class Execution:
    """How launch files are executed; `python` is one that has launch, None to look for one."""

    python: str | None = None
    seconds: float = DEFAULT_TIMEOUT_S

    def launch(
        self,
        path: Path,
        arguments: Mapping[str, str],
        environ: Mapping[str, str],
        files: WorkspaceSources,
    ) -> AppLaunch:
        """Return what a launch file starts with these arguments: its Python is run.

        Raise InputError where launch is not there, or the launch file raises; SourceError where it
        does not end.
        """
        with _temporary_folder() as folder:
            visit = _Visit(self, absolute_path(path), Path(folder), dict(files.workspace.packages))
            report = visit.report(arguments, environ)
            choices = LaunchChoices(arguments=arguments, environ=environ)
            packages = visit.packages
            evaluator = LaunchEvaluator(
                environ=environ, packages=packages, choices=choices, symbolic=True
            )
            texts = ReportTexts(
                commands=report.commands,
                file=visit.file,
                prefix=str(visit.prefix),
                packages=packages,
                evaluator=evaluator,
            )
            _check_error(report, texts)
            return ReportTranslator(
                report=report, texts=texts, generated_folder=visit.generated_folder
            ).launch()


@dataclass(frozen=True, slots=True)
class _Visit:
    """One visit of a file, all that it leaves behind in a folder."""

    execution: Execution
    file: str
    folder: Path
    packages: Mapping[str, Path]

    @property
    def prefix(self) -> Path:
        """Where the packages of the source stand as if they were installed."""
        return self.folder / "prefix"

    @property
    def generated_folder(self) -> Path:
        """Where the files lie that launch makes, and what it logs."""
        return self.folder / "made"

    def report(self, arguments: Mapping[str, str], environ: Mapping[str, str]) -> VisitReport:
        """Return what a visit with the first Python tells that has launch."""
        self.generated_folder.mkdir()
        self._install_packages()
        result, request = self.folder / "result.json", self.folder / "request.json"
        request_fields = {
            "file": self.file,
            "arguments": list(arguments.items()),
            "result": str(result),
        }
        request.write_text(json.dumps(request_fields), encoding="utf-8")
        visit_environ = self._environ({**os.environ, **environ})
        chosen_python = self.execution.python
        candidates = [chosen_python] if chosen_python else list(find_pythons(visit_environ))
        for python in candidates:
            self._run([python, str(_VISIT), str(request)], visit_environ)
            report = read_report(result)
            if not report.missing:
                return report
        help = "source your ROS 2, or name a Python that has launch: --launch-python"
        raise InputError(f"launch_ros is not installed in {', '.join(candidates)}", help=help)

    def _run(self, command: list[str], environ: Mapping[str, str]) -> None:
        log = self.folder / "said"
        try:
            with log.open("wb") as stream:
                run_with_timeout(command, environ, self.execution.seconds, stream)
        except SourceError as error:
            raise SourceError(f"{self.file}: {error}") from None
        if not (self.folder / "result.json").exists():
            raise SourceError(f"{self.file}: the visit ended without a word: {_log_tail(log)}")

    def _install_packages(self) -> None:
        """Let the packages of the source be found, after those that are installed."""
        index = self.prefix / "share" / "ament_index" / "resource_index" / "packages"
        index.mkdir(parents=True)
        for name, folder in self.packages.items():
            if _NAME.fullmatch(name) and name != "ament_index":
                (index / name).touch()
                (self.prefix / "share" / name).symlink_to(folder.absolute())

    def _environ(self, environ: Mapping[str, str]) -> dict[str, str]:
        before = environ.get("AMENT_PREFIX_PATH", "")
        return {
            **environ,
            "AMENT_PREFIX_PATH": ":".join(filter(None, (before, str(self.prefix)))),
            "PYTHONDONTWRITEBYTECODE": "1",
            "ROS_LOG_DIR": str(self.generated_folder),
            "TMPDIR": str(self.generated_folder),
        }


def _temporary_folder() -> "tempfile.TemporaryDirectory[str]":
    return tempfile.TemporaryDirectory(prefix="rtron-visit-", ignore_cleanup_errors=True)


def _log_tail(log: Path) -> str:
    with log.open("rb") as stream:
        stream.seek(-min(_MAX_LOG_BYTES, log.stat().st_size), os.SEEK_END)
        return stream.read().decode(errors="replace").strip()


def _check_error(report: VisitReport, texts: ReportTexts) -> None:
    """Raise InputError for an exception that ended the launch."""
    if report.error is None:
        return
    location = report.error.place
    help = "without --execute-launch the file is read, nothing of it is run"
    raise InputError(
        f"launch ends: {display_text(texts.resolve(report.error.text))}",
        path=texts.resolve_path(location.file) or texts.file,
        line=location.line,
        help=help,
    )


_Key: TypeAlias = tuple[str, str, str, str, str]


def add_lines(executed: AppLaunch, read: AppLaunch) -> AppLaunch:
    """Return what was executed, with the lines that are known from reading the same file."""
    locations: dict[_Key, set[Evidence]] = defaultdict(set)
    for start in read.starts:
        locations[_key(start)].add(start.evidence)
    return replace(
        executed,
        starts=tuple(_with_line(start, locations) for start in executed.starts),
        declared=read.declared,
    )


def _with_line(start: LaunchStart, locations: dict[_Key, set[Evidence]]) -> LaunchStart:
    matches = locations.get(_key(start), set()) if not start.evidence.line else set()
    return replace(start, evidence=next(iter(matches))) if len(matches) == 1 else start


def _key(start: LaunchStart) -> _Key:
    return start.kind, start.package, start.program, start.name, start.evidence.file


_PLACEHOLDER_START = "{"
"""How what is not known of a text begins where it is shown; a text may be written so, too."""


def is_incomplete(launch: AppLaunch) -> bool:
    """Tell whether something of a launch is not known."""
    return bool(launch.unresolved) or any(map(_is_incomplete_start, launch.starts))


def _is_incomplete_start(start: LaunchStart) -> bool:
    unsure = start.is_uncertain or not start.parameters_complete
    return (
        unsure
        or any(_PLACEHOLDER_START in text for text in _texts(start))
        or _has_unknown_parameter(start)
    )


def _texts(start: LaunchStart) -> Iterator[str]:
    yield from (start.package, start.program, start.full_name, start.container, *start.arguments)
    for pair in (*start.remaps, *start.environ):
        yield from pair


def _has_unknown_parameter(start: LaunchStart) -> bool:
    return any(
        isinstance(parameter.value, UnknownValue)
        for source in start.parameter_sources
        for _, values in source.entries
        for parameter in values.values()
    )
