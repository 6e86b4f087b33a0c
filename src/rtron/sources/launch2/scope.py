"""What counts at a place of a ROS 2 launch: configurations, namespace and shared remaps."""

from dataclasses import dataclass, field

UNKNOWN = "*"
"""Stands for a name, or a namespace, that only the running launch knows."""


@dataclass(slots=True)
class Scope:
    """One scope; actions change it for all that comes after them in it.

    `namespace` is None where nothing was pushed, else absolute or UNKNOWN. `remaps` are those of
    `set_remap`, in order. `unknown` are configurations that are set, to what is not known.
    """

    configurations: dict[str, str] = field(default_factory=dict)
    namespace: str | None = None
    remaps: list[tuple[str, str]] = field(default_factory=list)
    doubtful: bool = False
    unknown: set[str] = field(default_factory=set)

    def put(self, name: str, value: str | None) -> None:
        """Set a configuration; None for a value that only the running launch knows."""
        self.configurations.pop(name, None)
        self.unknown.discard(name)
        if value is None:
            self.unknown.add(name)
        else:
            self.configurations[name] = value

    def inner(self, *, forwarding: bool = True) -> "Scope":
        """Return the scope of a group; without `forwarding` it begins empty."""
        if not forwarding:
            return Scope(doubtful=self.doubtful)
        return Scope(
            configurations=dict(self.configurations),
            namespace=self.namespace,
            remaps=list(self.remaps),
            doubtful=self.doubtful,
            unknown=set(self.unknown),
        )

    def space(self, own: str | None) -> str | None:
        """Return the namespace of a node, or what it is after a push; None for no namespace."""
        if own is None or (own and own.startswith("/")):
            return self.namespace if own is None else canonical(own)
        if UNKNOWN in (own, self.namespace):
            return UNKNOWN
        return canonical(f"{self.namespace or ''}/{own}")


def canonical(space: str) -> str:
    """Return a namespace with one slash before each part."""
    return "/" + "/".join(part for part in space.split("/") if part)
