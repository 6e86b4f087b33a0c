"""Quality of service that parameters override: `qos_overrides.<topic>.publisher.depth`.

An endpoint is made with the policies that may be overridden, each of which is a parameter of its
node, named by the topic as it is remapped (docs.ros.org: rclcpp, QosOverridingOptions;
github.com/ros2/rclpy@9.1.2, qos_overriding_options.py).
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace

from rtron.sources.code.interpreter.abstract_values.items import items_of, listed
from rtron.sources.code.interpreter.abstract_values.value_types import (
    NONE,
    Hole,
    Instance,
    Known,
    NativeClass,
    Value,
    spelled,
)
from rtron.sources.code.interpreter.execution.abstract_machine import Machine
from rtron.sources.code.interpreter.execution.arguments import Arguments
from rtron.sources.code.library_models.ros2_common.nodes import name_of, takes_globals
from rtron.sources.code.library_models.ros2_common.parameters import declared
from rtron.sources.code.library_models.ros2_common.qos import (
    DEPTH,
    DURABILITY,
    RELIABILITY,
    fields_of,
    qos_of,
)
from rtron.sources.declaration import DeclarationKind
from rtron.vocabulary import Liveliness, QoS
from rtron.vocabulary.remap_rules import remaps_at

POLICIES, IDENTITY = "overriding.policies", "overriding.id"
KINDS = (
    *("avoid_ros_namespace_conventions", "deadline", "depth", "durability", "history", "lifespan"),
    *("liveliness", "liveliness_lease_duration", "reliability"),
)
"""QosPolicyKind of both client libraries, as the parameters are called."""

_DEFAULT_POLICIES = listed(tuple(map(Known, ("history", "depth", "reliability"))))
_ENDS = {DeclarationKind.PUBLISH: "publisher", DeclarationKind.SUBSCRIBE: "subscription"}
_FIELDS = {"depth": DEPTH, "reliability": RELIABILITY, "durability": DURABILITY}
_FOREVER, _MANUAL = 2**63 - 1, Liveliness.MANUAL_BY_TOPIC
_PREFIX, _NO_ID = "qos_overrides.", Known("")


def overriding(cls: NativeClass, policies: Value, identity: Value | None) -> Instance:
    """Return the options that let these policies be overridden."""
    return Instance(cls, {POLICIES: policies, IDENTITY: identity or _NO_ID})


def with_default_policies(cls: NativeClass, identity: Value | None) -> Instance:
    """Return the options of `QosOverridingOptions::with_default_policies(callback, id)`."""
    return overriding(cls, _DEFAULT_POLICIES, identity)


@dataclass(frozen=True, slots=True)
class Overridable:
    """An endpoint that is made with options by which parameters may override its policies."""

    machine: Machine
    kind: DeclarationKind
    node: Value
    at: Arguments

    def qos(self, name: Value, qos: QoS | None, options: Value | None) -> QoS | None:
        """Return what it has by its node's parameters; None where that is open, which is noted."""
        if options is None or options == NONE or self.kind not in _ENDS or qos is None:
            return qos
        fields = options.fields if isinstance(options, Instance) else {}
        identity, policies = fields.get(IDENTITY), fields.get(POLICIES)
        topic = self._topic(name)
        if topic is None or not (isinstance(identity, Known) and _is_closed(policies)):
            return self._open(name) if self._is_set(topic or "") else qos
        ending = f"_{identity.value}" if identity.value else ""
        return self._by_parameters(f"{_PREFIX}{topic}.{_ENDS[self.kind]}{ending}", policies, qos)

    def _by_parameters(self, prefix: str, policies: Value | None, qos: QoS) -> QoS | None:
        written = _policies(qos)
        for policy in items_of(policies or _NO_ID)[0]:
            word = spelled(policy)
            if not (word == "lifespan" and self.kind is DeclarationKind.SUBSCRIBE):
                name = Known(f"{prefix}.{word}")
                found = declared(self.machine, self.node, name, written.get(word, Hole(word)))
                likely = self.machine.recorder.likely(found)
                written[word] = likely[0] if len(likely) == 1 else Hole(word)
        read = _qos(written)
        return _with_times(read, written) if read is not None else self._open(Known(prefix))

    def _topic(self, name: Value) -> str | None:
        """Return the topic that the parameters are named by: as it is remapped."""
        full = spelled(name_of(self.node))
        rules = self.machine.recorder.site.rules if takes_globals(self.node) else ()
        fitting = (r.target for r in remaps_at(rules, full) if r.declared == spelled(name))
        return next(fitting, spelled(name)) if isinstance(name, Known) else None

    def _is_set(self, topic: str) -> bool:
        """Tell whether the launch sets such a parameter, of this topic or of any."""
        own = dict(self.machine.recorder.site.overrides)
        names = (*(one.name for one in self.machine.recorder.site.settings), *own)
        return any(name.startswith(f"{_PREFIX}{topic}") for name in names)

    def _open(self, name: Value) -> QoS | None:
        what = f"quality of service of {self.kind.value} {spelled(name)}"
        why = "parameters override it, and what they make of it is not known"
        self.machine.recorder.unresolved(what, why, self.at.evidence)
        return None


def _is_closed(policies: Value | None) -> bool:
    items, certain = items_of(policies) if policies is not None else ((), False)
    return certain and all(isinstance(item, Known) and item.value in KINDS for item in items)


def _policies(qos: QoS) -> dict[str, Value]:
    """Return the policies as their parameters spell them; what they are declared with."""
    fields = fields_of(qos)
    written = {word: fields[field] for word, field in _FIELDS.items()}
    return {**written, "history": Known("keep_last" if qos.depth else "keep_all")}


def _qos(policies: Mapping[str, Value]) -> QoS | None:
    """Return what policies say; None where one of them is not known, or is none."""
    fields: dict[object, Value] = {field: policies[word] for word, field in _FIELDS.items()}
    depth, history = fields[DEPTH], policies["history"]
    if not (isinstance(depth, Known) and isinstance(history, Known)):
        return None
    if history.value == "keep_all":
        fields[DEPTH] = Known(0)
    return qos_of(Instance(_READ, fields))


def _with_times(qos: QoS, policies: Mapping[str, Value]) -> QoS:
    """Return what is asked for besides, where parameters give it: times in ns, and liveliness."""
    given = {w: p.value for w, p in policies.items() if isinstance(p, Known)}
    manual = given.get("liveliness") == _MANUAL.value
    return replace(
        qos,
        deadline=_time(given.get("deadline")),
        lifespan=_time(given.get("lifespan")),
        lease=_time(given.get("liveliness_lease_duration")),
        liveliness=_MANUAL if manual else qos.liveliness,
    )


def _time(given: object) -> int:
    return given if isinstance(given, int) and given < _FOREVER else 0


_READ = NativeClass("rmw_qos_profile_t")
