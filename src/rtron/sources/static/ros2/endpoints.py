"""From what a node of ROS 2 declares to the graph: remap rules, services, actions as units."""

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path

from rtron.errors import InputError
from rtron.sources.code.workspace_sources import WorkspaceSources
from rtron.sources.declaration import Declaration, DeclarationKind, NodeSite, ParameterSetting
from rtron.sources.launch.ros2.parameters.file import parameter_entries, parse_yaml_tree
from rtron.sources.static.common.endpoints import DIRECTIONS, ROLES
from rtron.vocabulary import (
    Action,
    Endpoint,
    ParameterValue,
    Resolution,
    Ros2ActionEntity,
    Service,
    ServiceClient,
)
from rtron.vocabulary.parameters import pattern_matches
from rtron.vocabulary.remap_rules import RemapRule, remaps_for_node

_SERVICES: Mapping[DeclarationKind, type[Service | ServiceClient]] = {
    DeclarationKind.SERVICE: Service,
    DeclarationKind.SERVICE_CLIENT: ServiceClient,
}
_REMAPS_ACTIONS = "kilted"
"""The first distribution in which the name of an action can be remapped (ros2/rcl, 1170)."""
_SEND_GOAL = f"/_action/{Ros2ActionEntity.SEND_GOAL.value}"


@dataclass(frozen=True, slots=True)
class RemapRules:
    """The remap rules of a node: the first for a name counts, and is not applied twice (rcl)."""

    rules: tuple[RemapRule, ...]
    node: str
    distribution: str = ""

    def __call__(self, name: str) -> str:
        """Return the name that a declared name stands for."""
        fitting = (r.target for r in remaps_for_node(self.rules, self.node) if r.source == name)
        return next(fitting, name)

    def action(self, name: str) -> str:
        """Return the name that a declared action stands for: that of its service for goals.

        Since Kilted, or where it is not known, a rule for the action itself counts, too.
        """
        if not self.distribution or self.distribution >= _REMAPS_ACTIONS:
            name = self(name)
        return self(name + _SEND_GOAL).removesuffix(_SEND_GOAL)


def graph_entities(
    node: str, declarations: Iterable[Declaration], rules: RemapRules
) -> Iterator[Endpoint | Service | Action | ServiceClient]:
    """Yield what the graph has of a node's declarations."""
    for declared in declarations:
        if declared.kind in DIRECTIONS:
            yield _endpoint(node, declared, rules)
        elif declared.kind in _SERVICES:
            name, implicit = rules(declared.name), declared.implicit
            entity_type = _SERVICES[declared.kind]
            yield entity_type(node=node, name=name, type=declared.type, implicit=implicit)
        elif declared.kind in ROLES:
            name, role = rules.action(declared.name), ROLES[declared.kind]
            yield Action(node=node, name=name, type=declared.type, role=role)


def _endpoint(node: str, declared: Declaration, rules: RemapRules) -> Endpoint:
    topic = rules(declared.name)
    return Endpoint(
        node=node,
        topic=topic,
        direction=DIRECTIONS[declared.kind],
        type=declared.type,
        declared_name=declared.name,
        implicit=declared.implicit,
        resolution=Resolution.SYMBOLIC if "{" in topic else declared.resolution,
        qos=declared.qos,
        evidence=declared.evidence,
    )


def parameter_value(site: NodeSite, node: str, parameter: str) -> ParameterValue | None:
    """Return a parameter's value, the last that fits the node's full name; None for none."""
    is_own = node == site.name
    settings = site.node_settings if is_own else site.settings
    values = [s.value for s in settings if s.name == parameter and pattern_matches(s.node, node)]
    if is_own:
        values += [value for name, value in site.overrides if name == parameter]
    return values[-1] if values else None


def parameter_file_settings(path: str, files: WorkspaceSources) -> Iterator[ParameterSetting]:
    """Yield what a parameter file sets; raise InputError where it cannot be read."""
    text = files.read_text(Path(path))
    if text is None:
        raise InputError("is not in the folders that are read", path=path)
    for node, values in parameter_entries(parse_yaml_tree(text, path), path):
        for name, parameter in values.items():
            yield ParameterSetting(node=node, name=name, value=parameter.value)
