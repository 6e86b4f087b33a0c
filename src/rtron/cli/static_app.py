"""An app in source, as the command line names it."""

import os
import shlex
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING

from rtron.cli.assignments import ASSIGNED, assignments
from rtron.cli.progress import shown_progress
from rtron.errors import InputError
from rtron.sources.static.options import ScanOptions
from rtron.vocabulary import InteractionGraph

if TYPE_CHECKING:
    from rtron.sources.workspace import Workspace

_TAKEN = "ROS_PACKAGE_PATH"


@dataclass(frozen=True, slots=True, kw_only=True)
class StaticChoice:
    """The options that only an app in source has."""

    launches: Sequence[str] = ()
    env: Sequence[str] = ()
    jobs: int | None = None
    use_cache: bool = True


@dataclass(frozen=True, slots=True)
class StaticSource:
    """A Source that scans folders for what launch files start."""

    folders: tuple[Path, ...]
    launches: tuple[tuple[Path, Mapping[str, str]], ...]
    environ: Mapping[str, str]
    options: ScanOptions
    workspace: "Workspace"

    def read(self) -> InteractionGraph:
        """Return the graph, with a progress bar where somebody sees it."""
        from rtron.sources.static.app import scan_app  # noqa: PLC0415 - the guard starts without it

        with shown_progress() as progress:
            options = replace(self.options, progress=progress)
            return scan_app(self.folders, self.launches, self.environ, options).graph

    def descriptions(self, graph: InteractionGraph) -> Mapping[str, str]:
        """Return what the manifests of the packages say whose nodes are in a graph."""
        used = {node.package for node in graph.nodes} & self.workspace.packages.keys()
        return {package: self.workspace.manifest(package).description for package in used}


def static_source(
    folders: Sequence[Path], arguments: Sequence[str], choice: StaticChoice
) -> StaticSource:
    """Return the app in source; raise InputError for a launch file that is not there."""
    from rtron.sources.static.cache import user_cache  # noqa: PLC0415 - the guard starts without it
    from rtron.sources.static.launch_paths import find_launch  # noqa: PLC0415 - the guard starts without it
    from rtron.sources.workspace import read_workspace  # noqa: PLC0415 - the guard starts without it

    if not choice.launches:
        help = f"rtron scan {shlex.quote(str(folders[0]))} lists the launch files"
        raise InputError("--launch is missing", help=help)
    environ = _environ(choice.env)
    workspace = read_workspace(folders, environ)
    shared = assignments(arguments)
    words = [_words(launch) for launch in choice.launches]
    launches = [
        (find_launch(spelled, workspace), {**shared, **assignments(own)}) for spelled, *own in words
    ]
    options = ScanOptions(cache=user_cache() if choice.use_cache else None)
    if choice.jobs:
        options = replace(options, workers=choice.jobs)
    return StaticSource(tuple(folders), tuple(launches), environ, options, workspace)


def _environ(given: Sequence[str]) -> dict[str, str]:
    for each in given:
        if "=" not in each or each.startswith("=") or ASSIGNED in each:
            raise InputError(f"what is --env {each}?", help="write --env NAME=VALUE")
    environ = {_TAKEN: os.environ[_TAKEN]} if _TAKEN in os.environ else {}
    return environ | dict(each.split("=", 1) for each in given)


def _words(launch: str) -> list[str]:
    try:
        return shlex.split(launch) or [""]
    except ValueError as error:
        help = "quote the whole: --launch 'pkg/file.launch name:=value'"
        raise InputError(f"{launch}: {error}", help=help) from None
