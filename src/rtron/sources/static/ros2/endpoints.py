"""From what a node of ROS 2 declares to the graph: remap rules, services, actions as units."""

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass

from rtron.sources.declaration import Declaration, DeclarationKind
from rtron.sources.static.common.endpoints import DIRECTIONS, ROLES
from rtron.vocabulary import (
    Action,
    ActionEnd,
    Endpoint,
    Resolution,
    Service,
    ServiceClient,
)
from rtron.vocabulary.remap_rules import Rule, remaps_at

_SERVICES: Mapping[DeclarationKind, type[Service | ServiceClient]] = {
    DeclarationKind.SERVICE: Service,
    DeclarationKind.SERVICE_CLIENT: ServiceClient,
}
_GOALS = f"/_action/{ActionEnd.SEND_GOAL.value}"


@dataclass(frozen=True, slots=True)
class Rules:
    """The remap rules of a node: the first for a name counts, and is not applied twice (rcl)."""

    rules: tuple[Rule, ...]
    node: str

    def __call__(self, name: str) -> str:
        """Return the name that a declared name stands for."""
        fitting = (r.target for r in remaps_at(self.rules, self.node) if r.declared == name)
        return next(fitting, name)


def joined(
    node: str, declarations: Iterable[Declaration], rules: Rules
) -> Iterator[Endpoint | Service | Action | ServiceClient]:
    """Yield what the graph has of a node's declarations."""
    for declared in declarations:
        if declared.kind in DIRECTIONS:
            yield _endpoint(node, declared, rules)
        elif declared.kind in _SERVICES:
            name, implicit = rules(declared.name), declared.implicit
            sort = _SERVICES[declared.kind]
            yield sort(node=node, name=name, type=declared.type, implicit=implicit)
        elif declared.kind in ROLES:
            name = rules(declared.name + _GOALS).removesuffix(_GOALS)
            role = ROLES[declared.kind]
            yield Action(node=node, name=name, type=declared.type, role=role)


def _endpoint(node: str, declared: Declaration, rules: Rules) -> Endpoint:
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
