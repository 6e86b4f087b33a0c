"""Where a model is evaluated: at which node, below which namespaces, with which variables.

What is not known of a value stands in braces.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Any

from rtron.sources.declaration import NodeSite
from rtron.vocabulary.launch import canonical_name
from rtron.vocabulary.parameters import UnknownValue
from rtron.vocabulary.remap_rules import remaps_for_node

Value = Any
MAX_DEPTH = 20


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


class Placeholder(str):
    """A value that is not known: its name in braces, `{~prefix}`; stays a hole when looked into."""

    __slots__ = ()


def placeholder(name: str) -> Placeholder:
    """Return the hole for a name, whatever braces it already has."""
    return Placeholder("{" + name.replace("{", "").replace("}", "") + "}")


def with_placeholders(value: Value, name: str, depth: int = 0) -> Value:
    """Return a parameter's value with a hole for each UnknownValue, and for what is too deep."""
    if isinstance(value, UnknownValue) or depth > MAX_DEPTH:
        return placeholder(name)
    if isinstance(value, Mapping):
        return {
            key: with_placeholders(inner, f"{name}/{key}", depth + 1)
            for key, inner in value.items()
        }
    if isinstance(value, (list, tuple)):
        return [with_placeholders(inner, f"{name}/{i}", depth + 1) for i, inner in enumerate(value)]
    return value


def has_placeholder(value: Value) -> bool:
    """Tell whether a value is, or was built from, something that is not known."""
    return isinstance(value, str) and "{" in value


def as_switch(value: Value) -> bool:
    """Return what a value means as a switch: `0`, `false`, `no`, `off` and nothing are false."""
    if isinstance(value, str):
        return value.strip().lower() not in {"", "0", "false", "no", "off"}
    return bool(value)
