"""Where a model is evaluated: at which node, below which namespaces, with which variables."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace

from rtron.sources.declaration import NodeSite
from rtron.sources.models.values import Value
from rtron.vocabulary.launch import canonical_name


@dataclass(frozen=True, slots=True, kw_only=True)
class Scope:
    """The two handles of a model and its variables.

    Names `a` resolve below `namespace`, names `~a` below `private`; both are absolute. A name that
    an expression put behind `~` may be absolute itself (`~/scan` is `/scan`).
    """

    site: NodeSite
    namespace: str
    private: str
    variables: Mapping[str, Value] = field(default_factory=dict)

    def resolve(self, name: str) -> str:
        """Return a name as it resolves here, before remapping."""
        own = name.removeprefix("~")
        if own.startswith("/"):
            return canonical_name(own)
        parent = self.private if name.startswith("~") else self.namespace
        return canonical_name(f"{parent}/{own}")

    def remapped(self, name: str) -> str:
        """Return a name as it resolves here, after remapping."""
        resolved = self.resolve(name)
        return dict(self.site.remaps).get(resolved, resolved)

    def having(self, variables: Mapping[str, Value]) -> "Scope":
        """Return this scope with more variables."""
        return replace(self, variables={**self.variables, **variables})


def scope_at(site: NodeSite) -> Scope:
    """Return the scope of a node itself."""
    return Scope(site=site, namespace=site.name.rpartition("/")[0] or "/", private=site.name)
