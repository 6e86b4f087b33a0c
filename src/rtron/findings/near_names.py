"""Which names may be meant for one another."""

from collections.abc import Collection
from difflib import SequenceMatcher

_NEAR_RATIO = 0.8
MOST_COMPARED = 200
"""Among more names of one type a near one tells nothing, and comparing them takes long."""
_TRANSPORTS = ("/compressed", "/compressedDepth", "/theora", "/ffmpeg", "/zstd")
"""What image_transport adds to a topic's name (ROS wiki: image_transport)."""


def is_near(one: str, other: str) -> bool:
    """Return whether two names may be meant for one: a namespace more or less, a slip.

    So may one that the other says more about, as `data` and `data_compass` do.
    """
    (namespace, _, name), (other_namespace, _, other_name) = (
        _without_transport(each).rpartition("/") for each in (one, other)
    )
    if namespace == other_namespace:
        one, other = name, other_name
        if name == other_name:
            return False
        if says_more(name, other_name):
            return True
    elif name == other_name:
        if _is_within(namespace, other_namespace):
            return True
        one, other = namespace, other_namespace
    shorter, longer = sorted((len(one), len(other)))
    if 2 * shorter < _NEAR_RATIO * (shorter + longer):
        return False
    return SequenceMatcher(None, one, other).ratio() >= _NEAR_RATIO


def _is_within(one: str, other: str) -> bool:
    """Return whether one namespace is the other with more before or behind it."""
    shorter, longer = sorted((one, other), key=len)
    return longer.startswith(f"{shorter}/") or longer.endswith(shorter)


def are_beside(one: str, other: str) -> bool:
    """Return whether two topics are of one namespace, and of one transport if they are images."""
    bare = _without_transport(one), _without_transport(other)
    (parent, _, name), (other_parent, _, other_name) = (each.rpartition("/") for each in bare)
    same = one.removeprefix(bare[0]) == other.removeprefix(bare[1])
    return parent == other_parent and name != other_name and same


def _without_transport(name: str) -> str:
    ending = next((each for each in _TRANSPORTS if name.endswith(each)), "")
    return name.removesuffix(ending)


def says_more(one: str, other: str) -> bool:
    """Return whether one of two names is the other with words before or behind it."""
    return _is_qualified(one, other) or _is_qualified(other, one)


def _is_qualified(longer: str, shorter: str) -> bool:
    return len(shorter) > 2 and (  # noqa: PLR2004 - a part of two letters tells nothing
        longer.startswith(f"{shorter}_") or longer.endswith(f"_{shorter}")
    )


def near_names(name: str, others: Collection[str]) -> list[str]:
    """Return which of other names are near; none if there are so many that it tells nothing."""
    if len(others) > MOST_COMPARED:
        return []
    return sorted({other for other in others if is_near(name, other)})
