"""Under which key expressions rmw_zenoh sends what a ROS name stands for.

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

from rtron.errors import InputError

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
