"""Gazebo's server, which launches of ROS 2 start as a process: its system plugins and its world.

gzserver(1); gazebo_ros (src/node.cpp): the system plugins share a node, `gazebo`, and each plugin
of a world is a node of its own.
"""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import pairwise
from pathlib import Path

from rtron.errors import InputError
from rtron.sources.code.workspace_sources import WorkspaceSources
from rtron.sources.declaration import NodeSite
from rtron.sources.gazebo import GazeboPlugin, GazeboWorld, read_world
from rtron.sources.launch.ros2.element_site import SourceLocator
from rtron.sources.launch.ros2.result import LaunchStart
from rtron.sources.models import PluginElement, plugin_interface
from rtron.sources.models.common.arguments import positional, user_arguments
from rtron.sources.static.common.app_node import AppNode
from rtron.sources.static.common.node_part import NodePart
from rtron.sources.static.common.unresolved import UnresolvedList
from rtron.sources.static.ros2.gazebo_plugins import PACKAGE, USE_SIM_TIME, GazeboPluginNodes
from rtron.sources.workspace.package_files import is_regular
from rtron.vocabulary import Evidence, UnresolvedCause

_HOOK_KINDS = frozenset({"prepend-non-duplicate", "prepend-non-duplicate-if-exists"})
_SUFFIXES = (".dsv", ".dsv.in")
_PROJECT = "@PROJECT_NAME@"


def hook_folders(variable: str, files: WorkspaceSources) -> Iterator[Path]:
    """Yield the folders that the workspace's packages put into a variable of the environment."""
    workspace = files.workspace
    for package, folder in workspace.packages.items():
        for name in workspace.files(package).names:
            text = files.read_text(folder / name) if name.endswith(_SUFFIXES) else None
            for line in (text or "").splitlines():
                kind, _, rest = line.strip().replace(_PROJECT, package).partition(";")
                named, _, value = rest.partition(";")
                share = f"share/{package}"
                if (
                    kind in _HOOK_KINDS
                    and named == variable
                    and f"{value}/".startswith(f"{share}/")
                ):
                    yield folder / value.removeprefix(share).strip("/")


_SERVERS = frozenset({"gzserver", "gazebo"})
_SYSTEM_PLUGIN_OPTIONS = ("-s", "--server-plugin")
_VALUED = (
    "-s --server-plugin -g --gui-plugin -e --physics -p --play -o --profile --iters --seed "
    "--initial_sim_time --record_path --record_encoding --record_period --record_filter"
)
_DEFAULT_WORLD = f"{{find-pkg-share {PACKAGE}}}/worlds/empty.world"
"""The world of gazebo_ros that its launch file has by default, without a plugin."""
_MAX_SERVERS = 16
_MODELS, _RESOURCES = "GAZEBO_MODEL_PATH", "GAZEBO_RESOURCE_PATH"


def gazebo_server_node(start: LaunchStart, environ: Mapping[str, str]) -> AppNode | None:
    """Return the server that a process is; None for another program."""
    program, *words = start.arguments or ("",)
    if Path(program).name not in _SERVERS:
        return None
    site = NodeSite(
        name="/gazebo",
        ros=2,
        args=tuple(words),
        environ=tuple({**environ, **dict(start.environ)}.items()),
        has_launch_name=False,
        settings=(USE_SIM_TIME,),
    )
    return AppNode(
        site=site,
        package=PACKAGE,
        type=Path(program).name,
        evidence=start.evidence,
        is_uncertain=start.is_uncertain,
    )


@dataclass(frozen=True, slots=True)
class GazeboServers:
    """Finds what the servers of an app load; `plugin_nodes` turns plugins into nodes.

    `environ` is the user's. Of what a launch tells Gazebo, only folders of the workspace count.
    """

    plugin_nodes: GazeboPluginNodes
    environ: Mapping[str, str]
    unresolved: UnresolvedList = field(default_factory=UnresolvedList)

    def parts(self, servers: Iterable[AppNode]) -> Iterator[NodePart]:
        """Yield a part for each plugin."""
        for number, server in enumerate(servers):
            if number == _MAX_SERVERS:
                self.unresolved.add(
                    "Gazebo", f"only {_MAX_SERVERS} servers are read", server.evidence
                )
                return
            yield from self._system_plugin_parts(server)
            modelled = list(self._modelled_plugins(self._world(server).plugins))
            yield from self.plugin_nodes.plugin_parts(
                modelled, NodePart(node=server, owner=server.name)
            )

    def _modelled_plugins(self, plugins: Iterable[GazeboPlugin]) -> Iterator[GazeboPlugin]:
        for plugin in plugins:
            if self.plugin_nodes.models.gazebo_plugin(plugin.filename):
                yield plugin
            else:
                self._unmodelled(plugin.filename, plugin.evidence)

    def _system_plugin_parts(self, server: AppNode) -> Iterator[NodePart]:
        for filename in _system_plugins(user_arguments(server.site.args)):
            model = self.plugin_nodes.models.gazebo_plugin(filename)
            if model is None:
                self._unmodelled(filename, server.evidence)
                continue
            element = PluginElement(filename=filename)
            interface = plugin_interface(model, server.site, element, self.plugin_nodes.models)
            yield NodePart(node=server, owner=server.name, model=model, interface=interface)

    def _unmodelled(self, filename: str, location: Evidence) -> None:
        what, cause = f"Gazebo plugin {filename}", UnresolvedCause.MISSING_CODE
        self.unresolved.add(what, "no model of it", location, cause=cause)

    def _world(self, server: AppNode) -> GazeboWorld:
        world_arguments = [word for word in positional(server.site.args, _VALUED) if word.strip()]
        if not world_arguments or world_arguments[0] == _DEFAULT_WORLD:
            return GazeboWorld()
        try:
            path = self._file(world_arguments[0], self._folders(_RESOURCES, server))
            packages = self.plugin_nodes.files.workspace.packages
            models = ":".join(self._folders(_MODELS, server))
            world = read_world(path, packages, {_MODELS: models})
        except InputError as error:
            self.unresolved.add(f"world {world_arguments[0]}", str(error), server.evidence)
            return GazeboWorld()
        self.unresolved.entries.extend(world.unresolved)
        return world

    def _file(self, path_text: str, folders: Iterable[str]) -> Path:
        files, installed = self.plugin_nodes.files, SourceLocator(self.plugin_nodes.files.workspace)
        for folder in ("/", *folders):
            path = Path(installed(str(Path(folder, path_text))))
            if files.is_in_package(path) and is_regular(path):
                return path
        raise InputError("is not found in the folders that are read")

    def _folders(self, variable: str, server: AppNode) -> list[str]:
        """Return the folders of a search path that are the user's, or lie in the workspace."""
        files, user_folders = self.plugin_nodes.files, self.environ.get(variable, "").split(":")
        hooked = map(str, hook_folders(variable, files))
        launch_folders = dict(server.site.environ).get(variable, "").split(":")
        folders = dict.fromkeys(filter(None, (*launch_folders, *hooked)))
        return [
            folder
            for folder in folders
            if folder in user_folders or files.is_in_package(Path(folder))
        ]


def _system_plugins(words: Sequence[str]) -> Iterator[str]:
    """Yield the values of `-s`, which may stand in the same word."""
    for word, following in pairwise((*words, "")):
        name, equals, value = word.partition("=")
        if name in _SYSTEM_PLUGIN_OPTIONS:
            yield value if equals else following
        elif word.startswith("-s"):
            yield word.removeprefix("-s").strip()
