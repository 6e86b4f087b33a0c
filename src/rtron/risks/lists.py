"""The words that the rules look for and the tables of topics: data, which a user may add to."""

import re
from collections.abc import Callable
from dataclasses import dataclass, fields
from functools import cache, cached_property, lru_cache
from importlib.resources import files
from pathlib import Path

from rtron.risks.list_parser import ListFileContent, parse_lists, read_text
from rtron.risks.topic_table import NamePatterns, TopicTable, TopicTableEntry
from rtron.vocabulary import Domain, Sharing, StreamKind, TopicClass, normalise_type, unstamped_type

_TYPE_CACHE_SIZE = 4096
_FALLBACK_KIND = {Domain.CONTROL: StreamKind.COMMAND, Domain.DRIVERS: StreamKind.COMMAND}


@dataclass(frozen=True, kw_only=True)
class RiskLists:
    """The lists of paper section 6.2 and its appendix, what is ignored, and the topic tables.

    The fields are named and explained in `data/lists.yaml` and `data/domains.yaml`. Message types
    are asked for in ROS 1 spelling (`normalise_type`).
    """

    event_msg_type: tuple[str, ...] = ()
    event_topic_name: tuple[str, ...] = ()
    action_msg_type: tuple[str, ...] = ()
    action_topic_name: tuple[str, ...] = ()
    action_answer: tuple[str, ...] = ()
    recog_topic_name: tuple[str, ...] = ()
    image_type: tuple[str, ...] = ()
    preprocessed_type: tuple[str, ...] = ()
    max_vel_name: tuple[str, ...] = ()
    max_vel_type: tuple[str, ...] = ()
    ignored_topics: tuple[str, ...] = ()
    ignored_types: tuple[str, ...] = ()
    ignored_packages: tuple[str, ...] = ()
    domains: tuple[TopicTableEntry, ...] = ()
    sharing: tuple[TopicTableEntry, ...] = ()
    kinds: tuple[TopicTableEntry, ...] = ()

    def is_event(self, message_type: str) -> bool:
        """Tell whether a type is in EVENT_MSG_TYPE."""
        return message_type in self._types["event_msg_type"]

    def is_action(self, message_type: str) -> bool:
        """Tell whether a type is in ACTION_MSG_TYPE, an action being known by its goals."""
        name = unstamped_type(message_type)
        actions = self._types["action_msg_type"]
        return name in actions or (name.endswith("ActionGoal") and name[: -len("Goal")] in actions)

    def is_image(self, message_type: str) -> bool:
        """Tell whether a type carries images."""
        return message_type in self._types["image_type"]

    def is_preprocessed(self, message_type: str) -> bool:
        """Tell whether a type carries sensory data, as Preprocessing hands them on."""
        return message_type in self._types["preprocessed_type"]

    def is_max_vel(self, message_type: str, topic: str) -> bool:
        """Tell whether a topic sets the maximal velocity."""
        fits = message_type in self._types["max_vel_type"]
        return fits and any(word in topic for word in self.max_vel_name)

    def names_event(self, topic: str) -> bool:
        """Tell whether a topic's name says that it tells an event."""
        return self._named["event_topic_name"].search(topic) is not None

    def names_action(self, topic: str) -> bool:
        """Tell whether a topic's name says that it makes the robot act."""
        return self._named["action_topic_name"].search(topic) is not None

    def ignores_topic(self, topic: str) -> bool:
        """Tell whether a topic is for logs only."""
        return self._patterns["ignored_topics"].match(topic)

    def ignores_type(self, message_type: str) -> bool:
        """Tell whether a type is for logs or visualisation only."""
        return self._ignores_type(message_type)

    def is_viewer(self, package: str) -> bool:
        """Tell whether a package records or shows what its nodes subscribe."""
        return self._patterns["ignored_packages"].match(package)

    def classify(self, message_type: str, topic: str) -> TopicClass:
        """Return what a topic is for."""
        domains, sharing, kinds = self._tables
        return _topic_class(
            domains.find(message_type, topic),
            sharing.find(message_type, topic),
            kinds.find(message_type, topic),
        )

    @cached_property
    def _types(self) -> dict[str, frozenset[str]]:
        names = (
            "event_msg_type",
            "action_msg_type",
            "image_type",
            "preprocessed_type",
            "max_vel_type",
        )
        return {name: frozenset(map(normalise_type, getattr(self, name))) for name in names}

    @cached_property
    def _named(self) -> dict[str, re.Pattern[str]]:
        names = ("event_topic_name", "action_topic_name")
        return {name: _any_word(getattr(self, name)) for name in names}

    @cached_property
    def _patterns(self) -> dict[str, NamePatterns]:
        names = ("ignored_topics", "ignored_types", "ignored_packages")
        return {name: NamePatterns(map(normalise_type, getattr(self, name))) for name in names}

    @cached_property
    def _ignores_type(self) -> Callable[[str], bool]:
        return lru_cache(_TYPE_CACHE_SIZE)(self._patterns["ignored_types"].match)

    @cached_property
    def _tables(self) -> tuple[TopicTable, TopicTable, TopicTable]:
        return TopicTable(self.domains), TopicTable(self.sharing), TopicTable(self.kinds)


def _any_word(words: tuple[str, ...]) -> re.Pattern[str]:
    """Return a pattern that finds any of the words, and nothing if there is none."""
    return re.compile("|".join(map(re.escape, words)) or r"(?!)")


@cache
def _topic_class(domain: str | None, sharing: str | None, kind: str | None) -> TopicClass:
    known = Domain(domain or Domain.OTHERS)
    return TopicClass(
        domain=known,
        sharing=Sharing(sharing or Sharing.CONTEND),
        kind=StreamKind(kind or _FALLBACK_KIND.get(known, StreamKind.STATE)),
    )


@cache
def default_lists() -> RiskLists:
    """Return the lists that ship with the rules, read on first use."""
    data = files("rtron.risks") / "data"
    names = ("lists.yaml", "domains.yaml")
    return _joined(*(parse_lists((data / name).read_text("utf-8"), name) for name in names))


def load_lists(path: Path | None = None) -> RiskLists:
    """Return the default lists, a file's words added to them and its table entries asked first."""
    defaults = default_lists()
    if path is None:
        return defaults
    additions = parse_lists(read_text(path), str(path))
    return _joined(
        additions, {field.name: getattr(defaults, field.name) for field in fields(RiskLists)}
    )


def _joined(*parts: ListFileContent) -> RiskLists:
    names = [field.name for field in fields(RiskLists)]
    return RiskLists(**{name: sum((part.get(name, ()) for part in parts), ()) for name in names})
