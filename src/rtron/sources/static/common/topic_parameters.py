"""Parameters that name topics which nobody uses, near others that are used."""

from collections.abc import Iterable, Iterator
from difflib import get_close_matches

from rtron.vocabulary import Evidence, ParameterValue, UnresolvedItem
from rtron.vocabulary.causes import UNUSED_TOPIC

_NEAR_RATIO = 0.8


def unused_topic_parameters(
    parameters: Iterable[tuple[str, ParameterValue, Evidence]], topics: set[str]
) -> Iterator[UnresolvedItem]:
    """Yield a note for each parameter, given with its value and place, that names no topic.

    It may name the namespace of topics.
    """
    for name, value, place in parameters:
        is_topic = isinstance(value, str) and value.startswith("/") and "topic" in name.lower()
        if is_topic and not any(f"{topic}/".startswith(f"{value}/") for topic in topics):
            for near in get_close_matches(value, sorted(topics), 1, _NEAR_RATIO):
                why = f"{UNUSED_TOPIC}, near {near}"
                what = f"parameter {name} is {value}"
                yield UnresolvedItem(what=what, why=why, evidence=(place,))
