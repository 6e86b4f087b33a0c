"""What runs inside Gazebo: the plugins of the robots that a launch of ROS 2 spawns.

gazebo_ros (src/node.cpp): each plugin is a node of its own, called like it, with the namespace and
the remaps of its `<ros>`; a namespace that the spawner gives counts before it. Of the systems of
the new Gazebo only gz_ros2_control joins ROS 2; the others need a bridge.
"""

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, replace

from rtron.errors import InputError
from rtron.sources.code.workspace_sources import WorkspaceFiles
from rtron.sources.declaration import NodeInterface, NodeSite, ParameterSetting
from rtron.sources.gazebo import GazeboPlugin, plugins_of
from rtron.sources.models import Models, plugin_interface
from rtron.sources.models.common.arguments import option
from rtron.sources.models.common.schema import Model, NodeRole
from rtron.sources.models.ros2.site import ros2_site
from rtron.sources.static.common.node_part import Part
from rtron.sources.static.ros1.simulation import placed, plugin_element
from rtron.sources.static.ros2.parameter_values import settings_of
from rtron.sources.static.ros2.spawned_model import Spawned, spawned_by
from rtron.sources.xacro import parse_element
from rtron.vocabulary import Unresolved
from rtron.vocabulary.launch import canonical_name
from rtron.vocabulary.remap_rules import Rule, rules_in

_SYSTEMS = ("gz-sim", "ignition-gazebo", "gz_", "ign_")
PACKAGE = "gazebo_ros"
SIMULATED = ParameterSetting(node="/**", name="use_sim_time", value=True)
"""gazebo_ros sets it for each of its nodes (include/gazebo_ros/node.hpp)."""
_MANAGER = "controller_manager"


@dataclass(frozen=True, slots=True)
class GazeboNodes:
    """Finds what the spawners among an app's parts bring into Gazebo."""

    models: Models
    files: WorkspaceFiles

    def parts(self, parts: Iterable[Part]) -> Iterator[Part]:
        """Yield a part for each plugin."""
        parts = tuple(parts)
        for spawner in parts:
            model = self.models.node(spawner.node.package, spawner.node.type)
            if model is not None and model.role is NodeRole.MODEL_SPAWNER:
                site = ros2_site(model.name, spawner.node.site)
                named = replace(spawner, node=replace(spawner.node, site=site))
                yield from self._of(named, parts)

    def _of(self, spawner: Part, parts: tuple[Part, ...]) -> Iterator[Part]:
        try:
            found = spawned_by(spawner, parts, self.files)
            plugins = _plugins(found) if found is not None else ()
        except InputError as error:
            yield _missing(spawner, f"what {spawner.node.name} spawns", str(error))
            return
        yield from self.loaded(plugins, spawner)

    def loaded(self, plugins: Iterable[GazeboPlugin], spawner: Part) -> Iterator[Part]:
        """Yield a part for each of some plugins; `spawner` may be the server that loads a world."""
        for plugin in plugins:
            model = self.models.gazebo_plugin(plugin.filename)
            if model is not None:
                yield self._part(plugin, model, spawner)
            elif not plugin.filename.startswith(_SYSTEMS):
                yield _missing(spawner, f"Gazebo plugin {plugin.filename}", "no model of it")

    def _part(self, plugin: GazeboPlugin, model: Model, spawner: Part) -> Part:
        """Return the part of a plugin's node; that of ros2_control hosts controllers."""
        below = option(spawner.node.site.args, "-robot_namespace") or ""
        rules, is_manager = _rules(plugin), model.role is NodeRole.CONTROLLER_MANAGER
        named = str(plugin.values.get(f"{_MANAGER}_name", _MANAGER)) if is_manager else plugin.name
        try:
            settings = tuple(self._settings(plugin)) if is_manager else ()
        except InputError as error:
            return _missing(spawner, f"parameters of {named}", str(error))
        site = NodeSite(
            name=canonical_name(f"/{below or _namespace(plugin)}/{named}"),
            ros=2,
            environ=spawner.node.site.environ,
            settings=(SIMULATED, *settings),
            remaps=rules,
        )
        kind = (_MANAGER, "ros2_control_node") if is_manager else (PACKAGE, plugin.filename)
        node = replace(
            spawner.node,
            site=site,
            package=kind[0],
            type=kind[1],
            evidence=plugin.evidence,
            rules=rules,
            container="",
        )
        found = plugin_interface(model, site, plugin_element(plugin, below), self.models)
        return Part(node=node, owner=site.name, model=model, interface=placed(found, node.evidence))

    def _settings(self, plugin: GazeboPlugin) -> Iterator[ParameterSetting]:
        given = plugin.values.get("parameters", [])
        for path in given if isinstance(given, list) else [given]:
            yield from settings_of(str(path).strip(), self.files)


def _plugins(spawned: Spawned) -> tuple[GazeboPlugin, ...]:
    found = plugins_of(parse_element(spawned.text, spawned.place.file))
    if spawned.is_file:
        return found
    return tuple(replace(plugin, evidence=spawned.place) for plugin in found)


def _ros(plugin: GazeboPlugin) -> Mapping[str, object]:
    ros = plugin.values.get("ros")
    return ros if isinstance(ros, dict) else plugin.values


def _namespace(plugin: GazeboPlugin) -> str:
    return str(_ros(plugin).get("namespace", "")).strip()


def _rules(plugin: GazeboPlugin) -> tuple[Rule, ...]:
    given = _ros(plugin).get("remapping", [])
    words = [str(one).strip() for one in (given if isinstance(given, list) else [given])]
    return tuple(rule for word in words for rule in rules_in(f"-r {word}", ros=True))


def _missing(spawner: Part, what: str, why: str) -> Part:
    """Return the spawner with a note instead of all that it declares."""
    note = Unresolved(what=what, why=why, evidence=(spawner.node.evidence,))
    nodes = spawner.interface.nodes
    return replace(spawner, model=None, interface=NodeInterface(nodes=nodes, unresolved=(note,)))
