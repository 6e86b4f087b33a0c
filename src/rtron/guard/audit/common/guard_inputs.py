"""What a plan says of who speaks to the guard, and of whom a plan's pattern means."""

from dataclasses import dataclass

from rtron.vocabulary import TopicAccess, matches_node
from rtron.vocabulary.topic_access import ANY_NODE


@dataclass(frozen=True, slots=True, kw_only=True)
class GuardInput:
    """A way into the guard: who publishes, under which public name, and on which private topic.

    `publishers` are node names or patterns.
    """

    public: str
    private: str
    publishers: tuple[str, ...]


def allows_anybody(topic: TopicAccess) -> bool:
    """Tell whether the plan lets anybody publish a topic."""
    return ANY_NODE in topic.publishers


def matches_any(patterns: tuple[str, ...], node: str) -> bool:
    """Tell whether one of a plan's names or patterns means a node."""
    return any(matches_node(pattern, node) for pattern in patterns)
