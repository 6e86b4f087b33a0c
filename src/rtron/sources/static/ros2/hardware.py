"""Hardware of ros2_control: classes that a controller manager loads for a robot description.

control.ros.org: ros2_control, "Hardware Components". A component runs in the manager's process,
whose arguments count for the nodes that it makes.
"""

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace

from rtron.errors import InputError
from rtron.sources.code.workspace_sources import WorkspaceSources
from rtron.sources.declaration import HardwareDescription, NodeInterface, NodeSite
from rtron.sources.models import Model, ModelCatalog, node_interface
from rtron.sources.models.common.schema import NodeRole
from rtron.sources.static.common.node_part import NodePart
from rtron.sources.static.common.task import InterpretationTask, TaskKind
from rtron.sources.static.ros2.endpoints import RemapRules, parameter_value
from rtron.sources.static.ros2.spawned_model import DESCRIPTION, published_description
from rtron.sources.xacro import XmlElement, parse_element
from rtron.vocabulary import UnknownValue, UnresolvedCause
from rtron.vocabulary.remap_rules import expand_name

_PLUGIN_BASE = "hardware_interface"
_JOINS_NOTHING = frozenset(
    {
        *("mock_components/GenericSystem", "fake_components/GenericSystem"),
        *("gazebo_ros2_control/GazeboSystem", "gz_ros2_control/GazeboSimSystem"),
        *("ign_ros2_control/IgnitionSystem", "mujoco_ros2_control/MujocoSystem"),
    }
)
"""Components that move joints of a simulation, or none."""


@dataclass(frozen=True, slots=True)
class HardwareParts:
    """Finds the hardware that the controller managers among an app's parts load."""

    models: ModelCatalog
    files: WorkspaceSources

    def parts(self, parts: Iterable[NodePart]) -> Iterator[NodePart]:
        """Yield a part for each component; what is not known of one is noted."""
        parts = tuple(parts)
        for manager in parts:
            model = self.models.node(manager.node.package, manager.node.type)
            if model is not None and model.role is NodeRole.CONTROLLER_MANAGER:
                yield from self._of_manager(manager, parts)

    def _of_manager(self, manager: NodePart, parts: Sequence[NodePart]) -> Iterator[NodePart]:
        nodes = manager.interface.nodes
        part, name = replace(manager, model=None, task=None), manager.node.name
        name = nodes[0].name if nodes else name
        try:
            text = _description(name, manager, parts)
            found = list(_read_hardware(text)) if text else []
        except InputError as error:
            yield part.with_missing_note(f"hardware of {name}", str(error))
            return
        for plugin, hardware in found:
            task, model = self._task(plugin, hardware, manager), self.models.hardware(plugin)
            if task is not None:
                yield replace(part, task=task)
            elif model is not None:
                yield replace(part, interface=self._interface(model, hardware, manager, name))
            elif plugin not in _JOINS_NOTHING:
                what = f"hardware {hardware.name} ({plugin})"
                why = "no source of it is here: what it joins is not"
                yield part.with_missing_note(what, why, UnresolvedCause.MISSING_SOURCE)

    def _interface(
        self, model: Model, hardware: HardwareDescription, manager: NodePart, name: str
    ) -> NodeInterface:
        """Return what a model says of a component: a node beside its manager's."""
        site = manager.node.site
        own = NodeSite(
            name=expand_name(model.name, name), ros=2, environ=site.environ, settings=site.settings
        )
        values = {"values": dict(hardware.parameters)}
        return node_interface(model, own, values, self.models).with_location(manager.node.evidence)

    def _task(
        self, plugin: str, hardware: HardwareDescription, manager: NodePart
    ) -> InterpretationTask | None:
        """Return the task of a component whose source is in the workspace."""
        found = self.files.workspace.plugin(plugin, _PLUGIN_BASE)
        if found is None or found.program is None or not found.program.sources:
            return None
        others = (c.type for c in self.files.workspace.plugins(_PLUGIN_BASE))
        return InterpretationTask(
            kind=TaskKind.HARDWARE,
            sources=found.program.sources,
            class_name=found.plugin_class.type,
            definitions=found.program.definitions,
            other_components=tuple(t for t in others if t != found.plugin_class.type),
            site=replace(manager.node.site, hardware=hardware),
        )


def _description(name: str, manager: NodePart, parts: Sequence[NodePart]) -> str:
    """Return the description that a manager gets; InputError if one is there and not known."""
    own = parameter_value(manager.node.site, name, DESCRIPTION)
    if isinstance(own, UnknownValue):
        raise InputError(own.why)
    if own is not None:
        return str(own)
    rules = RemapRules(manager.node.process_remap_rules, name)
    for spelled in (DESCRIPTION, f"~/{DESCRIPTION}"):
        text = published_description(rules(expand_name(spelled, name)), parts)
        if text is not None:
            return text
    return ""


def _read_hardware(text: str) -> Iterator[tuple[str, HardwareDescription]]:
    """Yield the plugin of each component, and what the description gives it."""
    for control in parse_element(text, DESCRIPTION).elements("ros2_control"):
        hardware = control.find("hardware")
        plugin = hardware.find("plugin") if hardware is not None else None
        if hardware is not None and plugin is not None and plugin.text:
            parameters = tuple(_parameters(hardware))
            name = control.attributes.get("name", "")
            yield plugin.text, HardwareDescription(name=name, parameters=parameters)


def _parameters(hardware: XmlElement) -> Iterator[tuple[str, str]]:
    for parameter in hardware.elements("param"):
        yield parameter.attributes.get("name", ""), parameter.text
