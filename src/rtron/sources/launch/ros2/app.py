"""What a launch file of an app starts: XML, YAML and Python, with all that it includes."""

from collections.abc import Mapping
from pathlib import Path

from rtron.errors import InputError
from rtron.sources.code.workspace_sources import WorkspaceSources
from rtron.sources.launch.ros2.choices import LaunchChoices
from rtron.sources.launch.ros2.element_site import SourceLocator
from rtron.sources.launch.ros2.evaluator import LaunchEvaluator
from rtron.sources.launch.ros2.python.front_end import PythonFrontEnd
from rtron.sources.launch.ros2.reader import LaunchReader, absolute_path
from rtron.sources.launch.ros2.result import AppLaunch
from rtron.sources.launch.ros2.start_collector import StartCollector
from rtron.vocabulary import Evidence, UnresolvedItem
from rtron.vocabulary.remap_rules import UNKNOWN_NAME


def read_app_launch(
    path: Path, arguments: Mapping[str, str], environ: Mapping[str, str], files: WorkspaceSources
) -> AppLaunch:
    """Return what a launch file starts with these arguments; nothing is run.

    What cannot be evaluated is noted: a condition then counts as true, and what is not known of a
    text stands in braces. A file that cannot be read at all has nothing but the note on it.
    """
    packages = files.workspace.packages
    choices = LaunchChoices(arguments=arguments, environ=environ)
    evaluator = LaunchEvaluator(
        environ=environ,
        packages=packages,
        choices=choices,
        symbolic=True,
        locate_source=SourceLocator(files.workspace),
    )
    front_end = PythonFrontEnd(files, evaluator)
    collector = StartCollector(evaluator, front_end.read)
    try:
        LaunchReader(evaluator, collector).root(path)
    except InputError as error:
        evaluator.unresolved.append(_unresolved_file(path, str(error), error.path, error.line))
    except RecursionError:
        evaluator.unresolved.append(_unresolved_file(path, "nested too deep"))
    missing = () if UNKNOWN_NAME in choices.declared else evaluator.missing_arguments()
    return AppLaunch(
        file=absolute_path(path),
        starts=tuple(collector.starts),
        arguments=tuple(collector.arguments),
        has_includes=evaluator.limits.files > 1,
        declared=frozenset(choices.declared),
        unresolved=tuple(evaluator.unresolved),
        wiring=tuple(dict.fromkeys((*evaluator.wiring, *missing))),
        generated_files=evaluator.files.generated_files,
    )


def _unresolved_file(path: Path, why: str, file: str = "", line: int = 0) -> UnresolvedItem:
    location = Evidence(file=file or str(path), line=line)
    return UnresolvedItem(what=path.name, why=why, evidence=(location,))
