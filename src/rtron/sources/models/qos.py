"""Quality of service in a model: a depth and policies, `5 best_effort`, `1 transient_local`."""

from rtron.vocabulary import Durability, QoS, Reliability


def parse_qos(text: str) -> QoS | None:
    """Return what words say, None for none; raise ValueError for what is no policy."""
    if not text:
        return None
    depth, reliability, durability = 0, Reliability.RELIABLE, Durability.VOLATILE
    for token in text.split():
        if token.isdecimal():
            depth = int(token)
        elif token in set(Reliability):
            reliability = Reliability(token)
        elif token in set(Durability):
            durability = Durability(token)
        else:
            raise ValueError(f"{token[:80]!r} is no quality of service")
    return QoS(depth=depth, reliability=reliability, durability=durability)
