"""Zenoh's access control of an app: a subject for each process, and what it may send and get.

Rules allow, the default denies. A rule that denies would not do: it matches a key expression that
lies within its own, and a sender may use a wider one. Flows are the router's: `ingress` comes from
a process, `egress` goes to it (zenoh, authorization.rs: policy_decision_point).

A message of `/a/b` has the key `<domain>/a/b/<type>/<type hash>`, and so have a service's requests
and replies (rmw_zenoh, liveliness_utils.cpp: TopicInfo; as of 0.1 for Humble to 0.10 for Lyrical).
What is stored for late subscribers lies below it, at `@adv` (zenoh-ext, advanced_publisher.rs), and
so do the keys of one subscriber alone (Lyrical's `rosidl::Buffer`).

The graph is made of liveliness tokens: `@ros2_lv/<domain>/<session>/<node>/<entity>/<kind>/
<enclave>/<namespace>/<node name>[/<name>/<type>/<type hash>/<QoS>]`, with `%` for each slash.

Only a type has `::` in it, and no ROS name can: so no key of one name is ever below another's,
whatever type and hash a sender invents.
"""

import re
from collections.abc import Callable, Iterable, Iterator, Sequence
from itertools import chain
from typing import Any, NamedTuple

from rtron.errors import InputError
from rtron.security.access.plan_rights import NODES_OF_OWN_PROCESSES
from rtron.security.access.rights import (
    AccessDoubt,
    AccessRight,
    AppAccess,
    ProcessAccess,
    RightKind,
)
from rtron.vocabulary import (
    GUARD_NODE,
    ROS2_ACTION_SERVICES,
    ROS2_ACTION_TOPICS,
    Mode,
    Plan,
    build_streams,
    ros2_entity_name,
)

_TYPE = "$*::$*"
_PART = re.compile(r"\*|[A-Za-z_][A-Za-z0-9_]*(?:\*[A-Za-z0-9_]*)?", re.ASCII)
_HIGHEST_DOMAIN = 232
_ANY_SESSION_NODE_ENTITY = "*/*/*"


class DomainKeys:
    """The key expressions of one ROS domain, 0 to 232.

    A `*` in a name stands for any characters; alone in its part, for slashes too. InputError if a
    name is none of ROS 2: what stands for more in a key expression (`*` and `$*` elsewhere, `?`,
    `#`, `@`) is not to come from a graph.
    """

    def __init__(self, domain: int) -> None:
        if not 0 <= domain <= _HIGHEST_DOMAIN:
            raise InputError(f"{domain} is no ROS domain", help=f"choose 0 to {_HIGHEST_DOMAIN}")
        self._domain = domain

    def data(self, name: str) -> str:
        """Return the keys of a topic's messages, or of a service's requests and replies."""
        return f"{self._domain}/{_path(name)}/{_TYPE}/**"

    def stored(self, name: str) -> str:
        """Return what a publisher of a topic offers to late subscribers, and its heartbeat."""
        return f"{self.data(name)}/@adv/pub/**"

    def recovery(self, name: str) -> str:
        """Return what a subscriber asks for such stored messages, and how it shows itself."""
        return f"{self.data(name)}/@adv/**"

    def node_token(self, node: str) -> str:
        """Return the token that says that a node is there."""
        return self._token("NN", node)

    def entity_token(self, kind: str, node: str, name: str) -> str:
        """Return the token of one of a node's entities: `kind` is MP, MS, SS or SC."""
        return f"{self._token(kind, node)}/{_mangled(_checked(name))}/**"

    def graph(self) -> str:
        """Return all tokens: what a node reads to know the graph."""
        return f"@ros2_lv/{self._domain}/**"

    def _token(self, kind: str, node: str) -> str:
        namespace, _, name = _checked(node).rpartition("/")
        return (
            f"@ros2_lv/{self._domain}/{_ANY_SESSION_NODE_ENTITY}/{kind}/*/"
            f"{_mangled(namespace or '/')}/{_mangled(name)}"
        )


def _path(name: str) -> str:
    """Return a name as parts of a key expression."""
    parts = _checked(name).removeprefix("/").split("/")
    return "/".join("*/**" if part == "*" else part.replace("*", "$*") for part in parts)


def _mangled(name: str) -> str:
    """Return a name as one part, as tokens have it (liveliness_utils.cpp: mangle_name)."""
    return "*" if name == "*" else name.replace("*", "$*").replace("/", "%")


def _checked(name: str) -> str:
    parts = name.split("/")
    if parts[0] or len(parts) == 1 or not all(map(_PART.fullmatch, parts[1:])):
        help = "a name of ROS 2 has letters, digits, `_` and slashes only"
        raise InputError(f"{name!r} is no full name of ROS 2", help=help)
    return name


_INGRESS, _EGRESS = "ingress", "egress"
_OFFER_STORED = ("put", "declare_queryable", "liveliness_token")
_ASK_STORED = ("declare_subscriber", "query", "declare_liveliness_subscriber")


class _Allowed(NamedTuple):
    """What a right on a name lets through: messages in a flow, under some of the name's keys."""

    kind: RightKind
    flow: str
    messages: tuple[str, ...]
    keys: Callable[[DomainKeys, str], str]


_ALLOWED = (
    _Allowed(RightKind.PUBLISH, _INGRESS, ("put", "reply"), DomainKeys.data),
    _Allowed(RightKind.PUBLISH, _INGRESS, _OFFER_STORED, DomainKeys.stored),
    _Allowed(RightKind.PUBLISH, _EGRESS, ("declare_subscriber",), DomainKeys.data),
    _Allowed(RightKind.PUBLISH, _EGRESS, ("declare_subscriber", "query"), DomainKeys.recovery),
    _Allowed(RightKind.SUBSCRIBE, _INGRESS, ("declare_subscriber",), DomainKeys.data),
    _Allowed(RightKind.SUBSCRIBE, _INGRESS, _ASK_STORED, DomainKeys.recovery),
    _Allowed(RightKind.SUBSCRIBE, _EGRESS, ("put", "reply"), DomainKeys.data),
    _Allowed(RightKind.SUBSCRIBE, _EGRESS, _OFFER_STORED, DomainKeys.stored),
    _Allowed(RightKind.REPLY, _INGRESS, ("declare_queryable", "reply"), DomainKeys.data),
    _Allowed(RightKind.REPLY, _EGRESS, ("query",), DomainKeys.data),
    _Allowed(RightKind.REQUEST, _INGRESS, ("query",), DomainKeys.data),
    _Allowed(RightKind.REQUEST, _EGRESS, ("declare_queryable", "reply"), DomainKeys.data),
)
"""Nobody may `delete`: rmw_zenoh never does."""

_ENTITIES = {
    RightKind.PUBLISH: "MP",
    RightKind.SUBSCRIBE: "MS",
    RightKind.REPLY: "SS",
    RightKind.REQUEST: "SC",
}
"""How a token says what an entity is (liveliness_utils.cpp)."""


def access_control(
    access: AppAccess, keys: DomainKeys, interfaces: Sequence[str]
) -> dict[str, Any]:
    """Return the section `access_control` of a router's configuration.

    Each process is known by the common name of its certificate, which is the process's name, and
    if `interfaces` are given, only where it comes in by one of them.
    """
    rules = {process.name: list(_rules(process, keys)) for process in access}
    only = {"interfaces": list(interfaces)} if interfaces else {}
    return {
        "enabled": True,
        "default_permission": "deny",
        "rules": list(chain.from_iterable(rules.values())),
        "subjects": [{"id": name, "cert_common_names": [name], **only} for name in rules],
        "policies": [
            {"rules": [rule["id"] for rule in of_process], "subjects": [name]}
            for name, of_process in rules.items()
        ],
    }


def guard_doubts(plan: Plan) -> tuple[AccessDoubt, ...]:
    """Return what a plan enforces: on rmw_zenoh no guard runs that would forward it.

    Its GIDs do not tell which participant has sent a message (docs/ros2.md).
    """
    streams = [stream.topic for stream in build_streams(plan) if stream.mode is Mode.ENFORCE]
    why = f"does not run on rmw_zenoh, so nobody forwards {', '.join(streams)}: say `mode: observe`"
    return (AccessDoubt(node=GUARD_NODE, what="the guard", why=why),) if streams else ()


def _rules(process: ProcessAccess, keys: DomainKeys) -> Iterator[dict[str, Any]]:
    rights = set(chain.from_iterable(map(_parts, process.rights)))
    for number, allowed in enumerate(_ALLOWED):
        names = (right.name for right in rights if right.kind is allowed.kind)
        expressions = sorted({allowed.keys(keys, name) for name in names})
        if expressions:
            yield _rule(f"{process.name}#{number}", allowed.flow, allowed.messages, expressions)
    reading = ("liveliness_query", "declare_liveliness_subscriber")
    yield _rule(f"{process.name}#graph", _INGRESS, reading, [keys.graph()])
    yield _rule(f"{process.name}#tokens", _EGRESS, ("liveliness_token",), [keys.graph()])
    own = sorted(set(_own_tokens(process, keys)))
    yield _rule(f"{process.name}#own", _INGRESS, ("liveliness_token",), own)


def _parts(right: AccessRight) -> Iterator[AccessRight]:
    """Yield a right on a topic or service as it is, one on an action as those on its parts."""
    if right.kind not in (RightKind.EXECUTE, RightKind.CALL):
        yield right
        return
    serves = right.kind is RightKind.EXECUTE
    for service in ROS2_ACTION_SERVICES:
        kind = RightKind.REPLY if serves else RightKind.REQUEST
        yield AccessRight(kind, ros2_entity_name(right.name, service))
    for topic in ROS2_ACTION_TOPICS:
        kind = RightKind.PUBLISH if serves else RightKind.SUBSCRIBE
        yield AccessRight(kind, ros2_entity_name(right.name, topic))


def _own_tokens(process: ProcessAccess, keys: DomainKeys) -> Iterator[str]:
    """Yield the tokens of a process: its nodes by their names, and what each may have."""
    for access in process.nodes:
        for node in NODES_OF_OWN_PROCESSES.get(access.node, (access.node,)):
            yield keys.node_token(node)
            for right in chain.from_iterable(map(_parts, access.rights)):
                yield keys.entity_token(_ENTITIES[right.kind], node, right.name)


def _rule(
    id: str, flow: str, messages: Iterable[str], expressions: Sequence[str]
) -> dict[str, Any]:
    return {
        "id": id,
        "permission": "allow",
        "flows": [flow],
        "messages": list(messages),
        "key_exprs": list(expressions),
    }
