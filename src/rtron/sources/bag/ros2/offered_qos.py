"""QoS as a recorder of ROS 2 writes it beside a topic: YAML with an entry for each publisher."""

import re
from functools import lru_cache
from itertools import islice

from rtron.vocabulary import Durability, QoS, Reliability

_MAX_TEXT = 2**16
_MAX_PUBLISHERS = 100
_ENTRY = re.compile(r"^- ", re.MULTILINE)
_FIELD = re.compile(r"^ *(depth|durability|reliability): *([0-9]{1,9}|[a-z_]+) *$", re.MULTILINE)
_RELIABILITY = {"2": Reliability.BEST_EFFORT, "best_effort": Reliability.BEST_EFFORT}
_DURABILITY = {"1": Durability.TRANSIENT_LOCAL, "transient_local": Durability.TRANSIENT_LOCAL}


def parse_offered_qos(text: str) -> tuple[QoS, ...]:
    """Return the QoS of each publisher that `offered_qos_profiles` lists, of the first 100.

    Recorders write numbers (rmw's enumerations) or their names; what is neither reads as ROS 2's
    default. The text is taken apart by its lines, without a YAML parser: it is always written by
    a machine in one form, and there may be thousands.
    """
    if len(text) > _MAX_TEXT:
        return ()
    entries = islice(_ENTRY.split(text), 1, _MAX_PUBLISHERS + 1)
    return tuple(_qos(**dict(_FIELD.findall(entry))) for entry in entries)


@lru_cache(1024)
def _qos(reliability: str = "", durability: str = "", depth: str = "") -> QoS:
    return QoS(
        reliability=_RELIABILITY.get(reliability, Reliability.RELIABLE),
        durability=_DURABILITY.get(durability, Durability.VOLATILE),
        depth=int(depth) if depth.isdigit() else 0,
    )
