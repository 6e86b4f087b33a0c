"""What a node declares through its client library, found in source, a model or a plugin."""

from dataclasses import dataclass, field

from rtron.vocabulary import Evidence, Parameters, Resolution, Unresolved, Word


class DeclarationKind(Word):
    """The calls of a client library that join a node to others."""

    PUBLISH = "publish"
    SUBSCRIBE = "subscribe"
    SERVICE = "service"
    SERVICE_CLIENT = "service_client"
    ACTION_CLIENT = "action_client"
    ACTION_SERVER = "action_server"


@dataclass(frozen=True, slots=True, kw_only=True)
class Declaration:
    """One declared name.

    `name` is absolute, as it resolves in its node before any remapping; what is not known of it
    stands in braces (`/{~prefix}/scan`). An action's `name` is its namespace and its `type` ends
    in `Action`. `implicit` marks what a library declares by itself.
    """

    kind: DeclarationKind
    name: str
    type: str = ""
    implicit: bool = False
    latched: bool = False
    resolution: Resolution = Resolution.LITERAL
    evidence: tuple[Evidence, ...] = ()


@dataclass(frozen=True, slots=True, kw_only=True)
class NodeSite:
    """A node where it runs: its full name, its command line and the parameters of the launch.

    `remaps` lead from absolute declared names to absolute targets. `complete` says that
    `parameters` holds all there are: what is not in it is not set.
    """

    name: str
    args: tuple[str, ...] = ()
    parameters: Parameters = field(default_factory=Parameters)
    remaps: tuple[tuple[str, str], ...] = ()
    environ: tuple[tuple[str, str], ...] = ()
    complete: bool = True


@dataclass(frozen=True, slots=True, kw_only=True)
class StartedLaunch:
    """A launch file, or a node, that a node starts itself."""

    path: str
    args: tuple[str, ...] = ()
    evidence: tuple[Evidence, ...] = ()


@dataclass(frozen=True, slots=True, kw_only=True)
class NodeInterface:
    """All that one node declares, and what of it could not be found out."""

    declarations: tuple[Declaration, ...] = ()
    starts: tuple[StartedLaunch, ...] = ()
    unresolved: tuple[Unresolved, ...] = ()
