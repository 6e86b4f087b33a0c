"""Quality of service as it is written, where all of it is literal (docs.ros.org: About QoS)."""

from collections.abc import Mapping
from typing import TypeVar

from rtron.sources.code.interpreter.abstract_values.value_types import (
    Hole,
    Instance,
    Known,
    NativeClass,
    Value,
)
from rtron.vocabulary import Durability, QoS, Reliability

DEPTH, RELIABILITY, DURABILITY = "qos.depth", "qos.reliability", "qos.durability"

_Policy = TypeVar("_Policy", Reliability, Durability)
DEFAULT = QoS(depth=10)
PROFILES: Mapping[str, QoS] = {
    "default": DEFAULT,
    "sensor_data": QoS(depth=5, reliability=Reliability.BEST_EFFORT),
    "services_default": DEFAULT,
    "parameters": QoS(depth=1000),
    "parameter_events": QoS(depth=1000),
    "clock": QoS(depth=1, reliability=Reliability.BEST_EFFORT),
    "rosout": QoS(depth=1000, durability=Durability.TRANSIENT_LOCAL),
    "system_default": QoS(),
    "action_status_default": QoS(depth=1, durability=Durability.TRANSIENT_LOCAL),
}
"""rmw/qos_profiles.h, with what Fast DDS takes where the system's default is asked for."""


def fields_of(qos: QoS) -> dict[object, Value]:
    """Return a quality of service as the fields of an Instance."""
    return {
        DEPTH: Known(qos.depth),
        RELIABILITY: Known(qos.reliability.value),
        DURABILITY: Known(qos.durability.value),
    }


def made(cls: NativeClass, qos: QoS) -> Instance:
    """Return a quality of service as an object of a class."""
    return Instance(cls, fields_of(qos))


def qos_of(value: Value | None) -> QoS | None:
    """Return what a value says: a depth alone has the other defaults; None where it is open."""
    if isinstance(value, Known) and isinstance(value.value, int):
        return QoS(depth=value.value)
    if not isinstance(value, Instance) or RELIABILITY not in value.fields:
        return None
    fields = {**value.fields, **_assigned(value)}
    reliability = _word(Reliability, fields[RELIABILITY])
    durability = _word(Durability, fields.get(DURABILITY))
    if reliability is None or durability is None:
        return None
    depth = fields.get(DEPTH)
    count = depth.value if isinstance(depth, Known) and isinstance(depth.value, int) else 0
    return QoS(depth=count, reliability=reliability, durability=durability)


def _assigned(profile: Instance) -> dict[object, Value]:
    """Return what is assigned to the members of an `rmw_qos_profile_t`."""
    given = {name: profile.fields.get(name) for name in ("depth", "reliability", "durability")}
    return {
        f"qos.{name}": value if name == "depth" else policy(value)
        for name, value in given.items()
        if value is not None
    }


def is_qos(value: Value | None) -> bool:
    """Tell whether a value is a quality of service."""
    return isinstance(value, Instance) and RELIABILITY in value.fields


def policy(value: Value | None) -> Value:
    """Return a policy as the fields have it: `ReliabilityPolicy.BEST_EFFORT` is `best_effort`."""
    name = getattr(value, "name", "") or getattr(value, "why", "")
    found = getattr(value, "value", None)
    if isinstance(found, str):
        return Known(found)
    last = str(name).rpartition("::")[2].rpartition(".")[2].lower()
    for word in (*Reliability, *Durability):
        if last in {word.value, word.value.replace("_", "")} or last.endswith(f"_{word.value}"):
            return Known(word.value)
    return Hole("policy")


def _word(kind: type[_Policy], value: Value | None) -> _Policy | None:
    known = value.value if isinstance(value, Known) else None
    return next((word for word in kind if word.value == known), None)
