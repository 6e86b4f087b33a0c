"""Gazebo's server, which launches of ROS 2 start as a process: its system plugins and its world.

gzserver(1); gazebo_ros (src/node.cpp): the system plugins share a node, `gazebo`, and each plugin
of a world is a node of its own.
"""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import pairwise
from pathlib import Path

from rtron.errors import InputError
from rtron.sources.declaration import NodeSite
from rtron.sources.gazebo import GazeboPlugin, World, read_world
from rtron.sources.launch.ros2.result import Start
from rtron.sources.launch.ros2.source_locator import Installed
from rtron.sources.models import PluginElement, plugin_interface
from rtron.sources.models.common.arguments import own_arguments, positional
from rtron.sources.static.common.app_node import AppNode
from rtron.sources.static.common.node_part import Part
from rtron.sources.static.common.unresolved import Notes
from rtron.sources.static.ros2.gazebo_plugins import PACKAGE, SIMULATED, GazeboNodes
from rtron.sources.static.ros2_hooks import hooked_folders
from rtron.sources.workspace.package_files import is_regular
from rtron.vocabulary import Evidence

_SERVERS = frozenset({"gzserver", "gazebo"})
_SYSTEM = ("-s", "--server-plugin")
_VALUED = (
    "-s --server-plugin -g --gui-plugin -e --physics -p --play -o --profile --iters --seed "
    "--initial_sim_time --record_path --record_encoding --record_period --record_filter"
)
_OWN = f"{{find-pkg-share {PACKAGE}}}/worlds/empty.world"
"""The world of gazebo_ros that its launch file has by default, without a plugin."""
_MOST_SERVERS = 16
_MODELS, _RESOURCES = "GAZEBO_MODEL_PATH", "GAZEBO_RESOURCE_PATH"


def gazebo_server(start: Start, environ: Mapping[str, str]) -> AppNode | None:
    """Return the server that a process is; None for another program."""
    program, *words = start.arguments or ("",)
    if Path(program).name not in _SERVERS:
        return None
    site = NodeSite(
        name="/gazebo",
        ros=2,
        args=tuple(words),
        environ=tuple({**environ, **dict(start.environ)}.items()),
        named=False,
        settings=(SIMULATED,),
    )
    return AppNode(
        site=site,
        package=PACKAGE,
        type=Path(program).name,
        evidence=start.evidence,
        doubtful=start.doubtful,
        executed=start.executed,
    )


@dataclass(frozen=True, slots=True)
class GazeboServers:
    """Finds what the servers of an app load; `environ` is the user's, `nodes` makes plugins nodes.

    Where a launch tells Gazebo to look, only the folders of the workspace count.
    """

    nodes: GazeboNodes
    environ: Mapping[str, str]
    notes: Notes = field(default_factory=Notes)

    def parts(self, servers: Iterable[AppNode]) -> Iterator[Part]:
        """Yield a part for each plugin."""
        for number, server in enumerate(servers):
            if number == _MOST_SERVERS:
                self.notes.add("Gazebo", f"only {_MOST_SERVERS} servers are read", server.evidence)
                return
            yield from self._system(server)
            known = list(self._known(self._world(server).plugins))
            yield from self.nodes.loaded(known, Part(node=server, owner=server.name))

    def _known(self, plugins: Iterable[GazeboPlugin]) -> Iterator[GazeboPlugin]:
        for plugin in plugins:
            if self.nodes.models.gazebo_plugin(plugin.filename):
                yield plugin
            else:
                self._unmodelled(plugin.filename, plugin.evidence)

    def _system(self, server: AppNode) -> Iterator[Part]:
        for filename in _system_plugins(own_arguments(server.site.args)):
            model = self.nodes.models.gazebo_plugin(filename)
            if model is None:
                self._unmodelled(filename, server.evidence)
                continue
            element = PluginElement(filename=filename)
            found = plugin_interface(model, server.site, element, self.nodes.models)
            yield Part(node=server, owner=server.name, model=model, interface=found)

    def _unmodelled(self, filename: str, place: Evidence) -> None:
        self.notes.add(f"Gazebo plugin {filename}", "no model of it", place)

    def _world(self, server: AppNode) -> World:
        named = [word for word in positional(server.site.args, _VALUED) if word.strip()]
        if not named or named[0] == _OWN:
            return World()
        try:
            path = self._file(named[0], self._folders(_RESOURCES, server))
            packages = self.nodes.files.workspace.packages
            models = ":".join(self._folders(_MODELS, server))
            world = read_world(path, packages, {_MODELS: models})
        except InputError as error:
            self.notes.add(f"world {named[0]}", str(error), server.evidence)
            return World()
        self.notes.unresolved.extend(world.unresolved)
        return world

    def _file(self, spelled: str, folders: Iterable[str]) -> Path:
        files, installed = self.nodes.files, Installed(self.nodes.files.workspace)
        for folder in ("/", *folders):
            path = Path(installed(str(Path(folder, spelled))))
            if files.lies_in(path) and is_regular(path):
                return path
        raise InputError("is not found in the folders that are read")

    def _folders(self, variable: str, server: AppNode) -> list[str]:
        """Return the folders of a search path that are the user's, or lie in the workspace."""
        files, own = self.nodes.files, self.environ.get(variable, "").split(":")
        hooked = map(str, hooked_folders(variable, files))
        given = dict(server.site.environ).get(variable, "").split(":")
        folders = dict.fromkeys(filter(None, (*given, *hooked)))
        return [one for one in folders if one in own or files.lies_in(Path(one))]


def _system_plugins(words: Sequence[str]) -> Iterator[str]:
    """Yield the values of `-s`, which may stand in the same word."""
    for word, following in pairwise((*words, "")):
        name, equals, value = word.partition("=")
        if name in _SYSTEM:
            yield value if equals else following
        elif word.startswith("-s"):
            yield word.removeprefix("-s").strip()
