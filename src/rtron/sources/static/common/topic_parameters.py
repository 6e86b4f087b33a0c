"""Parameters that name topics which nobody uses, near others that are used."""

import re
from collections.abc import Collection, Iterable, Iterator
from difflib import SequenceMatcher, get_close_matches

from rtron.vocabulary import Evidence, ParameterValue, WiringFact, WiringFactKind

_NEAR_RATIO = 0.8
_MOST_COMPARED = 1_000
_TOPIC = re.compile(r"(?:/\w+){1,20}", re.ASCII)


def unused_topic_parameters(
    parameters: Iterable[tuple[str, ParameterValue, Evidence]], topics: set[str]
) -> Iterator[WiringFact]:
    """Yield a fact for each parameter, given with its value and place, that names no topic.

    It may name the namespace of topics. `topics` are those in use, and the sources of remaps.
    """
    known = sorted(topic for topic in topics if "{" not in topic)
    for name, value, place in parameters if len(known) <= _MOST_COMPARED else ():
        is_topic = isinstance(value, str) and _TOPIC.fullmatch(value) and "topic" in name.lower()
        if is_topic and not any(f"{topic}/".startswith(f"{value}/") for topic in topics):
            for near in get_close_matches(value, known, 1, _NEAR_RATIO):
                yield WiringFact(
                    kind=WiringFactKind.TOPIC_PARAMETER,
                    subject=name,
                    value=value,
                    others=(near,),
                    evidence=(place,),
                )


_MOST_COMPARED_NAMES = 10_000
"""So many pairs of names take a tenth of a second; a node that has more is left without."""
_LAST_PART = re.compile(r"[^./]*\Z")


def unread_parameter(node: str, name: str, near: str | None, *places: Evidence) -> WiringFact:
    """Return the fact that a node does not know a parameter, and the near one it knows."""
    kind = WiringFactKind.MISSPELT_PARAMETER if near else WiringFactKind.UNREAD_PARAMETER
    others = (near,) if near else ()
    return WiringFact(kind=kind, subject=node, value=name, others=others, evidence=places)


def near_parameters(names: Collection[str], unset: Collection[str]) -> dict[str, str]:
    """Return names with the nearest that is not set, each of which is near to one only."""
    if len(names) * len(unset) > _MOST_COMPARED_NAMES:
        return {}
    pairs = [(_likeness(name, other), name, other) for name in names for other in unset]
    near: dict[str, str] = {}
    for likeness, name, other in sorted(pairs, reverse=True):
        if likeness >= _NEAR_RATIO and name not in near and other not in near.values():
            near[name] = other
    return dict(sorted(near.items()))


def _likeness(one: str, other: str) -> float:
    """Return how alike two names of one group are, from 0 to 1; `maxSpeed` is `max_speed`."""
    words, other_words = (
        _LAST_PART.findall(each)[0].replace("_", "").lower() for each in (one, other)
    )
    if _LAST_PART.sub("", one) != _LAST_PART.sub("", other):
        return 0.0
    return SequenceMatcher(None, words, other_words).ratio()
