"""Quality of service as it is written, and as `qos_overrides.<topic>.publisher.depth` overrides it.

An endpoint is made with the policies that may be overridden, each of which is a parameter of its
node, named by the topic as it is remapped (docs.ros.org: rclcpp, QosOverridingOptions;
github.com/ros2/rclpy@9.1.2, qos_overriding_options.py).
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import TypeVar

from rtron.sources.code.interpreter import abstract_values as av
from rtron.sources.code.interpreter.execution.abstract_machine import AbstractMachine
from rtron.sources.code.interpreter.execution.arguments import Arguments
from rtron.sources.code.library_models.ros2_common.nodes import node_name, uses_global_arguments
from rtron.sources.code.library_models.ros2_common.parameters import declare_node_parameter
from rtron.sources.declaration import DeclarationKind
from rtron.vocabulary import Durability, Liveliness, QoS, Reliability
from rtron.vocabulary.remap_rules import remaps_for_node

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


POLICIES_FIELD, ID_FIELD = "overriding.policies", "overriding.id"
POLICY_KINDS = (
    *("avoid_ros_namespace_conventions", "deadline", "depth", "durability", "history", "lifespan"),
    *("liveliness", "liveliness_lease_duration", "reliability"),
)
"""QosPolicyKind of both client libraries, as the parameters are called."""

_DEFAULT_POLICIES = av.list_of(tuple(map(av.Scalar, ("history", "depth", "reliability"))))
_ENDPOINT_WORDS = {DeclarationKind.PUBLISH: "publisher", DeclarationKind.SUBSCRIBE: "subscription"}
_FIELDS = {"depth": DEPTH_FIELD, "reliability": RELIABILITY_FIELD, "durability": DURABILITY_FIELD}
_FOREVER, _MANUAL = 2**63 - 1, Liveliness.MANUAL_BY_TOPIC
_PREFIX, _NO_ID = "qos_overrides.", av.Scalar("")


def overriding_options(
    cls: av.LibraryClass, policies: av.Value, identity: av.Value | None
) -> av.Instance:
    """Return the options that let these policies be overridden."""
    return av.Instance(cls, {POLICIES_FIELD: policies, ID_FIELD: identity or _NO_ID})


def with_default_policies(cls: av.LibraryClass, identity: av.Value | None) -> av.Instance:
    """Return the options of `QosOverridingOptions::with_default_policies(callback, id)`."""
    return overriding_options(cls, _DEFAULT_POLICIES, identity)


@dataclass(frozen=True, slots=True)
class QosOverrides:
    """An endpoint that is made with options by which parameters may override its policies."""

    machine: AbstractMachine
    kind: DeclarationKind
    node: av.Value
    call: Arguments

    def effective_qos(
        self, name: av.Value, qos: QoS | None, options: av.Value | None
    ) -> QoS | None:
        """Return what it has by its node's parameters; None where that is open, which is noted."""
        if options is None or options == av.NONE or self.kind not in _ENDPOINT_WORDS or qos is None:
            return qos
        fields = options.fields if isinstance(options, av.Instance) else {}
        identity, policies = fields.get(ID_FIELD), fields.get(POLICIES_FIELD)
        topic = self._remapped_topic(name)
        if topic is None or not (isinstance(identity, av.Scalar) and _are_known_policies(policies)):
            return self._note_unknown(name) if self._is_set(topic or "") else qos
        ending = f"_{identity.value}" if identity.value else ""
        return self._from_parameters(
            f"{_PREFIX}{topic}.{_ENDPOINT_WORDS[self.kind]}{ending}", policies, qos
        )

    def _from_parameters(self, prefix: str, policies: av.Value | None, qos: QoS) -> QoS | None:
        written = _policy_values(qos)
        for policy in av.items_of(policies or _NO_ID)[0]:
            word = av.text_with_holes(policy)
            if not (word == "lifespan" and self.kind is DeclarationKind.SUBSCRIBE):
                name = av.Scalar(f"{prefix}.{word}")
                found = declare_node_parameter(
                    self.machine, self.node, name, written.get(word, av.Unknown(word))
                )
                likely = self.machine.recorder.reported_options(found)
                written[word] = likely[0] if len(likely) == 1 else av.Unknown(word)
        read = _qos_of_policies(written)
        if read is None:
            return self._note_unknown(av.Scalar(prefix))
        return _with_durations(read, written)

    def _remapped_topic(self, name: av.Value) -> str | None:
        """Return the topic that the parameters are named by: as it is remapped."""
        full = av.text_with_holes(node_name(self.node))
        rules = self.machine.recorder.site.remap_rules if uses_global_arguments(self.node) else ()
        fitting = (
            r.target for r in remaps_for_node(rules, full) if r.source == av.text_with_holes(name)
        )
        return next(fitting, av.text_with_holes(name)) if isinstance(name, av.Scalar) else None

    def _is_set(self, topic: str) -> bool:
        """Tell whether the launch sets such a parameter, of this topic or of any."""
        own = dict(self.machine.recorder.site.overrides)
        names = (*(one.name for one in self.machine.recorder.site.settings), *own)
        return any(name.startswith(f"{_PREFIX}{topic}") for name in names)

    def _note_unknown(self, name: av.Value) -> QoS | None:
        what = f"quality of service of {self.kind.value} {av.text_with_holes(name)}"
        why = "parameters override it, and what they make of it is not known"
        self.machine.recorder.add_unresolved(what, why, self.call.evidence)
        return None


def _are_known_policies(policies: av.Value | None) -> bool:
    items, certain = av.items_of(policies) if policies is not None else ((), False)
    return certain and all(
        isinstance(item, av.Scalar) and item.value in POLICY_KINDS for item in items
    )


def _policy_values(qos: QoS) -> dict[str, av.Value]:
    """Return the policies as their parameters spell them; what they are declared with."""
    fields = qos_fields(qos)
    written = {word: fields[field] for word, field in _FIELDS.items()}
    return {**written, "history": av.Scalar("keep_last" if qos.depth else "keep_all")}


def _qos_of_policies(policies: Mapping[str, av.Value]) -> QoS | None:
    """Return what policies say; None where one of them is not known, or is none."""
    fields: dict[object, av.Value] = {field: policies[word] for word, field in _FIELDS.items()}
    depth, history = fields[DEPTH_FIELD], policies["history"]
    if not (isinstance(depth, av.Scalar) and isinstance(history, av.Scalar)):
        return None
    if history.value == "keep_all":
        fields[DEPTH_FIELD] = av.Scalar(0)
    return read_qos(av.Instance(_PROFILE, fields))


def _with_durations(qos: QoS, policies: Mapping[str, av.Value]) -> QoS:
    """Return a profile with what parameters give besides: times in ns, and liveliness."""
    given = {w: p.value for w, p in policies.items() if isinstance(p, av.Scalar)}
    manual = given.get("liveliness") == _MANUAL.value
    return replace(
        qos,
        deadline=_duration(given.get("deadline")),
        lifespan=_duration(given.get("lifespan")),
        lease=_duration(given.get("liveliness_lease_duration")),
        liveliness=_MANUAL if manual else qos.liveliness,
    )


def _duration(given: object) -> int:
    return given if isinstance(given, int) and given < _FOREVER else 0


_PROFILE = av.LibraryClass("rmw_qos_profile_t")
