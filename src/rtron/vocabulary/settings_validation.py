"""Whether a guard can run under settings: every value within its bounds, every name known.

A guard asks this of settings before anything else; what a whole plan must fulfil besides is for
those who read plans.
"""

import math
import re
from collections.abc import Collection, Iterator

from rtron.vocabulary.effective_plan import MisfitError, effective
from rtron.vocabulary.enums import PolicyName, Sharing
from rtron.vocabulary.plan import GRCN, MSRCN, RSRCN, SECOND, Flow, Plan, Rule
from rtron.vocabulary.settings import (
    EmergencyStop,
    FlowSettings,
    NodeSettings,
    RuleSettings,
    Settings,
    TimedOverride,
)

LONGEST = 2**63 - 1
"""The longest duration, ns, and the greatest revision."""
PRIORITIES = (-(2**31), 2**31 - 1)
FASTEST = 1000.0
"""The greatest `max_vel_limit`, m/s, and `threshold`, metres per frame."""
SLOWEST = 1e-6
"""Nothing but 0 is closer to 0: it would be a slip."""
MOST_RULES = 200
MOST_BLOCKED = 1000
LONGEST_NAME = 255
LONGEST_TEXT = 1000
LONGEST_CONDITION = 4096
LONGEST_CONDITIONS = 8192
"""All conditions that settings have together: messages wait while they are read."""
_WORD = re.compile("[A-Za-z][A-Za-z0-9_]*")
_OF_GRCN = (
    PolicyName.BLOCK,
    PolicyName.FIFO_QUEUE,
    PolicyName.PRIORITY_QUEUE,
    PolicyName.PREEMPTION,
)
_RANKED = (PolicyName.PRIORITY_QUEUE, PolicyName.PREEMPTION)
_BY_RATE = (PolicyName.SAFE, PolicyName.SAFE_CONSTRAIN)
_BY_LIMIT = (PolicyName.CONSTRAIN, PolicyName.SAFE_CONSTRAIN)
_OF_RSRCN = (PolicyName.BLOCK, *_BY_RATE, PolicyName.CONSTRAIN)


def in_force(plan: Plan, settings: Settings) -> Plan:
    """Return the plan in force under settings; MisfitError if a guard cannot run it."""
    for fault in _values(settings):
        raise MisfitError(fault)
    after = effective(plan, settings)
    for fault in (*_faults(after), *_overridden(plan, settings)):
        raise MisfitError(fault)
    return after


def _values(settings: Settings) -> Iterator[str]:
    """Yield what is out of its bounds, whatever the plan is."""
    yield from _whole("revision", settings.revision, 0, LONGEST)
    for id, node in settings.nodes.items():
        yield from (f"{_short(id)}: {fault}" for fault in _node(node))
    for id, override in settings.overrides.items():
        yield from (f"override of {_short(id)}: {fault}" for fault in _override(override))
    if settings.stop:
        yield from (f"emergency stop: {fault}" for fault in _stop(settings.stop))


def _node(node: NodeSettings) -> Iterator[str]:
    for name in ("release_after", "max_age", "max_hold"):
        yield from _whole(name, getattr(node, name), 0, LONGEST)
    yield from _quantity("threshold", node.threshold, SLOWEST)
    if node.max_vel_limit != 0:
        yield from _quantity("max_vel_limit", node.max_vel_limit, SLOWEST)
    for name, flow in node.flows.items():
        yield from (f"{_short(name)}: {fault}" for fault in _flow(flow))
    if len(node.rules) > MOST_RULES:
        yield f"more than {MOST_RULES} rules"
    if sum(len(rule.when or "") for rule in node.rules.values()) > LONGEST_CONDITIONS:
        yield f"the conditions are longer than {LONGEST_CONDITIONS} characters together"
    for name, rule in node.rules.items():
        yield from (f"rule {_short(name)}: {fault}" for fault in _rule(name, rule))


def _flow(flow: FlowSettings) -> Iterator[str]:
    yield from _whole("priority", flow.priority, *PRIORITIES)
    yield from _whole("timeout", flow.timeout, 0, LONGEST)


def _rule(name: str, rule: RuleSettings) -> Iterator[str]:
    if len(name) > LONGEST_NAME or not _WORD.fullmatch(name):
        yield "a rule's name is a word of letters, digits and _"
    if len(rule.when or "") > LONGEST_CONDITION:
        yield f"a condition is longer than {LONGEST_CONDITION} characters"
    if len(rule.block or ()) > MOST_BLOCKED:
        yield f"it blocks more than {MOST_BLOCKED} flows"


def _override(override: TimedOverride) -> Iterator[str]:
    yield from _whole("until", override.until, 0, LONGEST)
    yield from _said(override)


def _stop(stop: EmergencyStop) -> Iterator[str]:
    yield from _whole("at", stop.at, 0, LONGEST)
    yield from _said(stop)


def _said(said: TimedOverride | EmergencyStop) -> Iterator[str]:
    for text in (said.by, said.reason):
        if len(text) > LONGEST_TEXT:
            yield f"a text is longer than {LONGEST_TEXT} characters"


def _whole(name: str, value: int | None, least: int, greatest: int) -> Iterator[str]:
    if value is not None and not least <= value <= greatest:
        yield f"{name} is not between {least} and {greatest}"


def _quantity(name: str, value: float | None, least: float) -> Iterator[str]:
    if value is not None and not (math.isfinite(value) and least <= value <= FASTEST):
        yield f"{name} is not between {least:g} and {FASTEST:g}"


def _overridden(plan: Plan, settings: Settings) -> Iterator[str]:
    known = {node.id for node in (plan.rsrcn, plan.msrcn) if node}
    for id in settings.overrides:
        if id not in known:
            yield f"{_short(id)} cannot be overridden"


def _faults(plan: Plan) -> Iterator[str]:
    """Yield what would keep a guard from running under a plan, or the plan from meaning it."""
    for grcn in plan.grcn:
        yield from _grcn(grcn)
    if plan.rsrcn:
        yield from _rsrcn(plan.rsrcn, plan)
    if plan.msrcn:
        yield from _msrcn(plan.msrcn)


def _grcn(grcn: GRCN) -> Iterator[str]:
    yield from _policy(grcn.id, grcn.policy, _OF_GRCN)
    if grcn.sharing is Sharing.MERGE:
        yield from _policy(grcn.id, grcn.policy, (PolicyName.BLOCK,))
    if grcn.policy in _RANKED:
        yield from _order(grcn.id, grcn.flows)


def _rsrcn(rsrcn: RSRCN, plan: Plan) -> Iterator[str]:
    yield from _policy(rsrcn.id, rsrcn.policy, _OF_RSRCN)
    if rsrcn.policy in _BY_LIMIT and rsrcn.max_vel_limit is None:
        yield f"{rsrcn.id}: {rsrcn.policy} needs max_vel_limit"
    if rsrcn.policy in _BY_RATE:
        yield from _by_rate(rsrcn, plan)
    for topic in rsrcn.vflows:
        if len({flow.priority for flow in topic.flows}) > 1:
            yield from _order(rsrcn.id, topic.flows)


def _by_rate(rsrcn: RSRCN, plan: Plan) -> Iterator[str]:
    if rsrcn.threshold is None or not plan.fps_monitor:
        yield f"{rsrcn.id}: {rsrcn.policy} needs a threshold and an fps_monitor"
        return
    slowest = max(monitor.silent_after for monitor in plan.fps_monitor)
    if rsrcn.lowest > rsrcn.threshold * SECOND / slowest:
        why = "a silent image node would let the robot go faster than a slow one"
        yield f"{rsrcn.id}: a threshold of {rsrcn.threshold:g} m is too low: {why}"


def _msrcn(msrcn: MSRCN) -> Iterator[str]:
    yield from _policy(msrcn.id, msrcn.policy, (PolicyName.BLOCK,))
    if len(msrcn.rules) > MOST_RULES:
        yield f"{msrcn.id}: more than {MOST_RULES} rules"
    topics = {topic.topic: {flow.name for flow in topic.flows} for topic in msrcn.aflows}
    flows = {name: {name} for names in topics.values() for name in names}
    for rule in msrcn.rules:
        yield from (f"rule {rule.name}: {fault}" for fault in _blocks(rule, topics | flows))


def _blocks(rule: Rule, flows: dict[str, set[str]]) -> Iterator[str]:
    """Yield what is wrong with what a rule blocks; `flows` are those of each flow and topic."""
    for name in rule.block:
        if name not in flows:
            yield f"it blocks no aflow or topic that is called {_short(name)}"
    blocked = set[str]().union(*(flows.get(name, ()) for name in rule.block))
    needed = flows.get(rule.require)
    if rule.require in rule.block or (needed and needed <= blocked):
        yield f"it blocks {rule.require}, which it requires, so it could never end"


def _policy(id: str, policy: PolicyName, allowed: Collection[PolicyName]) -> Iterator[str]:
    if policy not in allowed:
        yield f"{id}: {policy} is not for it: choose from {', '.join(allowed)}"


def _order(id: str, flows: Collection[Flow]) -> Iterator[str]:
    named: dict[int, str] = {}
    for flow in flows:
        other = named.setdefault(flow.priority, flow.name)
        if other != flow.name:
            yield f"{id}: {other} and {flow.name} have the same priority {flow.priority}"


def _short(name: str) -> str:
    return repr(name[:LONGEST_NAME])
