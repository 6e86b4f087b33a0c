"""Where a model is evaluated: at which node, below which namespaces, with which variables."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace

from rtron.sources.declaration import NodeSite
from rtron.sources.models.common.values import Value
from rtron.vocabulary.launch import canonical_name
from rtron.vocabulary.remap_rules import remaps_for_node


@dataclass(frozen=True, slots=True, kw_only=True)
class ModelScope:
    """The two handles of a model and its variables.

    Names `a` resolve below `namespace`, names `~a` below `private`; both are absolute. A name that
    an expression put behind `~` may be absolute itself (`~/scan` is `/scan`). In ROS 2 it is not,
    and `private` is the full name of the node.
    """

    site: NodeSite
    namespace: str
    private: str
    variables: Mapping[str, Value] = field(default_factory=dict)

    def resolve(self, name: str) -> str:
        """Return a name as it resolves here, before remapping."""
        local_name = name.removeprefix("~")
        if local_name.startswith("/") and not (self.is_ros2 and name.startswith("~")):
            return canonical_name(local_name)
        parent = self.private if name.startswith("~") else self.namespace
        return canonical_name(f"{parent}/{local_name}")

    def remapped(self, name: str) -> str:
        """Return a name as it resolves here, after remapping."""
        resolved = self.resolve(name)
        if self.is_ros2:
            rules = remaps_for_node(self.site.remaps, self.private)
            return next((rule.target for rule in rules if rule.source == resolved), resolved)
        return dict(self.site.remaps).get(resolved, resolved)

    @property
    def is_ros2(self) -> bool:
        """Whether names and parameters are those of ROS 2."""
        return self.site.ros > 1

    def at_node(self, name: str) -> "ModelScope":
        """Return the scope of another node of the process, whose name is relative to this one."""
        full = self.resolve(name)
        return replace(self, namespace=full.rpartition("/")[0] or "/", private=full)

    def with_variables(self, variables: Mapping[str, Value]) -> "ModelScope":
        """Return this scope with more variables."""
        return replace(self, variables={**self.variables, **variables})


def node_scope(site: NodeSite) -> ModelScope:
    """Return the scope of a node itself."""
    return ModelScope(site=site, namespace=site.name.rpartition("/")[0] or "/", private=site.name)
