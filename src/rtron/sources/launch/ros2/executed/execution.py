"""Runs a launch file's Python with the real launch library, where the user asks for that.

In a process of its own, with a time limit, in the user's own environment; nothing that the launch
file starts is started (`visit`).
"""

import json
import os
import re
import tempfile
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from rtron.errors import InputError, SourceError
from rtron.sources.code.workspace_sources import WorkspaceFiles
from rtron.sources.launch.ros2.choices import Choices
from rtron.sources.launch.ros2.evaluator import Evaluator
from rtron.sources.launch.ros2.executed.python_process import run_bounded
from rtron.sources.launch.ros2.executed.pythons import pythons
from rtron.sources.launch.ros2.executed.report import Report, read_report
from rtron.sources.launch.ros2.executed.report_text import Marks
from rtron.sources.launch.ros2.executed.report_translator import Launched
from rtron.sources.launch.ros2.reader import absolute
from rtron.sources.launch.ros2.result import AppLaunch
from rtron.sources.launch.ros2.substitutions.template import shown

SECONDS = 60.0
_VISIT = Path(__file__).parent / "visit"
_MAX_SAID = 400
_NAME = re.compile(r"[A-Za-z0-9][\w.-]{0,200}")


@dataclass(frozen=True, slots=True, kw_only=True)
class Execution:
    """How launch files are executed; `python` is one that has launch, None to look for one."""

    python: str | None = None
    seconds: float = SECONDS

    def launch(
        self,
        path: Path,
        arguments: Mapping[str, str],
        environ: Mapping[str, str],
        files: WorkspaceFiles,
    ) -> AppLaunch:
        """Return what a launch file starts with these arguments: its Python is run.

        Raise InputError where launch is not there, or the launch file raises; SourceError where it
        does not end.
        """
        with _folder() as folder:
            visit = _Visit(self, absolute(path), Path(folder), dict(files.workspace.packages))
            report = visit.report(arguments, environ)
            choices = Choices(arguments=arguments, environ=environ)
            packages = visit.packages
            evaluator = Evaluator(
                environ=environ, packages=packages, choices=choices, symbolic=True
            )
            marks = Marks(
                commands=report.commands,
                file=visit.file,
                prefix=str(visit.prefix),
                packages=packages,
                evaluator=evaluator,
            )
            _check(report, marks)
            return Launched(report=report, marks=marks, made=visit.made).launch()


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
    def made(self) -> Path:
        """Where the files lie that launch makes, and what it logs."""
        return self.folder / "made"

    def report(self, arguments: Mapping[str, str], environ: Mapping[str, str]) -> Report:
        """Return what a visit with the first Python tells that has launch."""
        self.made.mkdir()
        self._install()
        result, request = self.folder / "result.json", self.folder / "request.json"
        asked = {"file": self.file, "arguments": list(arguments.items()), "result": str(result)}
        request.write_text(json.dumps(asked), encoding="utf-8")
        around = self._environ({**os.environ, **environ})
        own = self.execution.python
        tried = [own] if own else list(pythons(around))
        for python in tried:
            self._run([python, str(_VISIT), str(request)], around)
            report = read_report(result)
            if not report.missing:
                return report
        help = "source your ROS 2, or name a Python that has launch: --launch-python"
        raise InputError(f"launch_ros is not installed in {', '.join(tried)}", help=help)

    def _run(self, command: list[str], environ: Mapping[str, str]) -> None:
        said = self.folder / "said"
        try:
            with said.open("wb") as stream:
                run_bounded(command, environ, self.execution.seconds, stream)
        except SourceError as error:
            raise SourceError(f"{self.file}: {error}") from None
        if not (self.folder / "result.json").exists():
            raise SourceError(f"{self.file}: the visit ended without a word: {_last_words(said)}")

    def _install(self) -> None:
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
            "ROS_LOG_DIR": str(self.made),
            "TMPDIR": str(self.made),
        }


def _folder() -> "tempfile.TemporaryDirectory[str]":
    return tempfile.TemporaryDirectory(prefix="rtron-visit-", ignore_cleanup_errors=True)


def _last_words(said: Path) -> str:
    with said.open("rb") as stream:
        stream.seek(-min(_MAX_SAID, said.stat().st_size), os.SEEK_END)
        return stream.read().decode(errors="replace").strip()


def _check(report: Report, marks: Marks) -> None:
    """Raise InputError for an exception that ended the launch."""
    if report.error is None:
        return
    place = report.error.place
    help = "without --execute-launch the file is read, nothing of it is run"
    raise InputError(
        f"launch ends: {shown(marks.text(report.error.text))}",
        path=marks.path(place.file) or marks.file,
        line=place.line,
        help=help,
    )
