"""Parameters that name topics which nobody uses, near others that are used."""

import re
from collections.abc import Iterable, Iterator
from difflib import get_close_matches

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
