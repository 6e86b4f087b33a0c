"""What a launch file of an app starts: XML, YAML and Python, with all that it includes."""

from collections.abc import Mapping
from pathlib import Path

from rtron.errors import InputError
from rtron.sources.code.workspace_sources import WorkspaceFiles
from rtron.sources.launch.ros2.choices import Choices
from rtron.sources.launch.ros2.evaluator import Evaluator
from rtron.sources.launch.ros2.launch_context import Scope
from rtron.sources.launch.ros2.python.front_end import PythonFront
from rtron.sources.launch.ros2.reader import Reader, absolute
from rtron.sources.launch.ros2.result import AppLaunch
from rtron.sources.launch.ros2.source_locator import Installed
from rtron.sources.launch.ros2.start_collector import Starts
from rtron.vocabulary import Evidence, Unresolved


def read_app_launch(
    path: Path,
    arguments: Mapping[str, str],
    environ: Mapping[str, str],
    files: WorkspaceFiles,
) -> AppLaunch:
    """Return what a launch file starts with these arguments; nothing is run.

    What cannot be evaluated is noted: a condition then counts as true, and what is not known of a
    text stands in braces. A file that cannot be read at all has nothing but the note on it.
    """
    packages = files.workspace.packages
    choices = Choices(arguments=arguments, environ=environ)
    evaluator = Evaluator(
        environ=environ,
        packages=packages,
        choices=choices,
        symbolic=True,
        installed=Installed(files.workspace),
    )
    front = PythonFront(files, evaluator)
    starts = Starts(evaluator, front=front.read)
    try:
        Reader(evaluator, starts).root(absolute(path), Scope(dict(arguments), dict(environ)))
    except InputError as error:
        evaluator.unresolved.append(_note(path, str(error), error.path, error.line))
    except RecursionError:
        evaluator.unresolved.append(_note(path, "nested too deep"))
    return AppLaunch(
        file=absolute(path),
        starts=tuple(starts.starts),
        arguments=tuple(starts.arguments),
        includes=tuple(starts.includes[0]),
        unresolved=tuple(evaluator.unresolved),
        made=evaluator.files.made,
    )


def _note(path: Path, why: str, file: str = "", line: int = 0) -> Unresolved:
    place = Evidence(file=file or str(path), line=line)
    return Unresolved(what=path.name, why=why, evidence=(place,))
