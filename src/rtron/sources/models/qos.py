"""Quality of service in a model: a depth and policies, `5 best_effort`, `1 transient_local`."""

from rtron.vocabulary import Durability, QoS, Reliability


def qos_of(words: str) -> QoS | None:
    """Return what words say, None for none; raise ValueError for what is no policy."""
    if not words:
        return None
    depth, reliability, durability = 0, Reliability.RELIABLE, Durability.VOLATILE
    for word in words.split():
        if word.isdecimal():
            depth = int(word)
        elif word in set(Reliability):
            reliability = Reliability(word)
        elif word in set(Durability):
            durability = Durability(word)
        else:
            raise ValueError(f"{word[:80]!r} is no quality of service")
    return QoS(depth=depth, reliability=reliability, durability=durability)
