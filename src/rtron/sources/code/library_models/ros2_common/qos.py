"""Quality of service as it is written, where all of it is literal (docs.ros.org: About QoS)."""

from collections.abc import Mapping
from typing import TypeVar

from rtron.sources.code.interpreter import abstract_values as av
from rtron.vocabulary import Durability, QoS, Reliability

DEPTH_FIELD, RELIABILITY_FIELD, DURABILITY_FIELD = "qos.depth", "qos.reliability", "qos.durability"

_Policy = TypeVar("_Policy", Reliability, Durability)
DEFAULT_QOS = QoS(depth=10)
QOS_PROFILES: Mapping[str, QoS] = {
    "default": DEFAULT_QOS,
    "sensor_data": QoS(depth=5, reliability=Reliability.BEST_EFFORT),
    "services_default": DEFAULT_QOS,
    "parameters": QoS(depth=1000),
    "parameter_events": QoS(depth=1000),
    "clock": QoS(depth=1, reliability=Reliability.BEST_EFFORT),
    "rosout": QoS(depth=1000, durability=Durability.TRANSIENT_LOCAL),
    "system_default": QoS(),
    "action_status_default": QoS(depth=1, durability=Durability.TRANSIENT_LOCAL),
}
"""rmw/qos_profiles.h, with what Fast DDS takes for the system's default."""


def qos_fields(qos: QoS) -> dict[object, av.Value]:
    """Return a quality of service as the fields of an Instance."""
    return {
        DEPTH_FIELD: av.Scalar(qos.depth),
        RELIABILITY_FIELD: av.Scalar(qos.reliability.value),
        DURABILITY_FIELD: av.Scalar(qos.durability.value),
    }


def qos_object(cls: av.LibraryClass, qos: QoS) -> av.Instance:
    """Return a quality of service as an object of a class."""
    return av.Instance(cls, qos_fields(qos))


def read_qos(value: av.Value | None) -> QoS | None:
    """Return what a value says: a depth alone has the other defaults; None where it is open."""
    if isinstance(value, av.Scalar) and isinstance(value.value, int):
        return QoS(depth=value.value)
    if not isinstance(value, av.Instance) or RELIABILITY_FIELD not in value.fields:
        return None
    fields = {**value.fields, **_member_assignments(value)}
    reliability = _policy_word(Reliability, fields[RELIABILITY_FIELD])
    durability = _policy_word(Durability, fields.get(DURABILITY_FIELD))
    if reliability is None or durability is None:
        return None
    depth = fields.get(DEPTH_FIELD)
    count = depth.value if isinstance(depth, av.Scalar) and isinstance(depth.value, int) else 0
    return QoS(depth=count, reliability=reliability, durability=durability)


def _member_assignments(profile: av.Instance) -> dict[object, av.Value]:
    """Return what is assigned to the members of an `rmw_qos_profile_t`."""
    given = {name: profile.fields.get(name) for name in ("depth", "reliability", "durability")}
    return {
        f"qos.{name}": value if name == "depth" else policy_value(value)
        for name, value in given.items()
        if value is not None
    }


def is_qos(value: av.Value | None) -> bool:
    """Tell whether a value is a quality of service."""
    return isinstance(value, av.Instance) and RELIABILITY_FIELD in value.fields


def policy_value(value: av.Value | None) -> av.Value:
    """Return a policy as the fields have it: `ReliabilityPolicy.BEST_EFFORT` is `best_effort`."""
    name = getattr(value, "name", "") or getattr(value, "label", "")
    found = getattr(value, "value", None)
    if isinstance(found, str):
        return av.Scalar(found)
    last = str(name).rpartition("::")[2].rpartition(".")[2].lower()
    for word in (*Reliability, *Durability):
        if last in {word.value, word.value.replace("_", "")} or last.endswith(f"_{word.value}"):
            return av.Scalar(word.value)
    return av.Unknown("policy")


def _policy_word(kind: type[_Policy], value: av.Value | None) -> _Policy | None:
    known = value.value if isinstance(value, av.Scalar) else None
    return next((word for word in kind if word.value == known), None)
