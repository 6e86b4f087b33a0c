"""Whether a guard can run under settings: every value within its bounds, every name known.

A guard asks this of settings before anything else; what a whole plan must fulfil besides is for
those who read plans.
"""

import math
import re
from collections.abc import Collection, Iterator

from rtron.vocabulary.effective_plan import SettingsMismatchError, apply_settings
from rtron.vocabulary.enums import PolicyName, Sharing
from rtron.vocabulary.plan import GRCN, MSRCN, RSRCN, SECOND, Flow, MissionRule, Plan
from rtron.vocabulary.settings import (
    EmergencyStop,
    FlowSettings,
    NodeSettings,
    RuleSettings,
    Settings,
    TimedOverride,
)

MAX_INT64 = 2**63 - 1
"""The longest duration, ns, and the greatest revision."""
PRIORITY_RANGE = (-(2**31), 2**31 - 1)
MAX_VELOCITY = 1000.0
"""The greatest `max_vel_limit`, m/s, and `threshold`, metres per frame."""
MIN_NONZERO_VELOCITY = 1e-6
"""Nothing but 0 is closer to 0: it would be a slip."""
MAX_RULES = 200
MAX_BLOCKED_FLOWS = 1000
MAX_NAME_LENGTH = 255
MAX_TEXT_LENGTH = 1000
MAX_CONDITION_LENGTH = 4096
MAX_CONDITIONS_LENGTH = 8192
"""All conditions that settings have together: messages wait while they are read."""
_RULE_NAME = re.compile("[A-Za-z][A-Za-z0-9_]*")
_GRCN_POLICIES = (
    PolicyName.BLOCK,
    PolicyName.FIFO_QUEUE,
    PolicyName.PRIORITY_QUEUE,
    PolicyName.PREEMPTION,
)
_PRIORITY_POLICIES = (PolicyName.PRIORITY_QUEUE, PolicyName.PREEMPTION)
_FRAME_RATE_POLICIES = (PolicyName.SAFE, PolicyName.SAFE_CONSTRAIN)
_VELOCITY_LIMIT_POLICIES = (PolicyName.CONSTRAIN, PolicyName.SAFE_CONSTRAIN)
_RSRCN_POLICIES = (PolicyName.BLOCK, *_FRAME_RATE_POLICIES, PolicyName.CONSTRAIN)


def apply_valid_settings(plan: Plan, settings: Settings) -> Plan:
    """Return the plan in force under settings; MisfitError if a guard cannot run it."""
    for problem in _out_of_bounds(settings):
        raise SettingsMismatchError(problem)
    applied = apply_settings(plan, settings)
    for problem in (*_plan_problems(applied), *_unknown_overrides(plan, settings)):
        raise SettingsMismatchError(problem)
    return applied


def _out_of_bounds(settings: Settings) -> Iterator[str]:
    """Yield what is out of its bounds, whatever the plan is."""
    yield from _integer_bounds("revision", settings.revision, 0, MAX_INT64)
    for id, node in settings.nodes.items():
        yield from (f"{_quoted(id)}: {problem}" for problem in _node(node))
    for id, override in settings.overrides.items():
        yield from (f"override of {_quoted(id)}: {problem}" for problem in _override(override))
    if settings.stop:
        yield from (f"emergency stop: {problem}" for problem in _stop(settings.stop))


def _node(node: NodeSettings) -> Iterator[str]:
    for name in ("release_after", "max_age", "max_hold"):
        yield from _integer_bounds(name, getattr(node, name), 0, MAX_INT64)
    yield from _quantity_bounds("threshold", node.threshold, MIN_NONZERO_VELOCITY)
    if node.max_vel_limit != 0:
        yield from _quantity_bounds("max_vel_limit", node.max_vel_limit, MIN_NONZERO_VELOCITY)
    for name, flow in node.flows.items():
        yield from (f"{_quoted(name)}: {problem}" for problem in _flow(flow))
    if len(node.rules) > MAX_RULES:
        yield f"more than {MAX_RULES} rules"
    if sum(len(rule.when or "") for rule in node.rules.values()) > MAX_CONDITIONS_LENGTH:
        yield f"the conditions are longer than {MAX_CONDITIONS_LENGTH} characters together"
    for name, rule in node.rules.items():
        yield from (f"rule {_quoted(name)}: {problem}" for problem in _rule(name, rule))


def _flow(flow: FlowSettings) -> Iterator[str]:
    yield from _integer_bounds("priority", flow.priority, *PRIORITY_RANGE)
    yield from _integer_bounds("timeout", flow.timeout, 0, MAX_INT64)


def _rule(name: str, rule: RuleSettings) -> Iterator[str]:
    if len(name) > MAX_NAME_LENGTH or not _RULE_NAME.fullmatch(name):
        yield "a rule's name is a word of letters, digits and _"
    if len(rule.when or "") > MAX_CONDITION_LENGTH:
        yield f"a condition is longer than {MAX_CONDITION_LENGTH} characters"
    if len(rule.block or ()) > MAX_BLOCKED_FLOWS:
        yield f"it blocks more than {MAX_BLOCKED_FLOWS} flows"


def _override(override: TimedOverride) -> Iterator[str]:
    yield from _integer_bounds("until", override.until, 0, MAX_INT64)
    yield from _author_text(override)


def _stop(stop: EmergencyStop) -> Iterator[str]:
    yield from _integer_bounds("at", stop.at, 0, MAX_INT64)
    yield from _author_text(stop)


def _author_text(entry: TimedOverride | EmergencyStop) -> Iterator[str]:
    for text in (entry.by, entry.reason):
        if len(text) > MAX_TEXT_LENGTH:
            yield f"a text is longer than {MAX_TEXT_LENGTH} characters"


def _integer_bounds(name: str, value: int | None, least: int, greatest: int) -> Iterator[str]:
    if value is not None and not least <= value <= greatest:
        yield f"{name} is not between {least} and {greatest}"


def _quantity_bounds(name: str, value: float | None, least: float) -> Iterator[str]:
    if value is not None and not (math.isfinite(value) and least <= value <= MAX_VELOCITY):
        yield f"{name} is not between {least:g} and {MAX_VELOCITY:g}"


def _unknown_overrides(plan: Plan, settings: Settings) -> Iterator[str]:
    known = {node.id for node in (plan.rsrcn, plan.msrcn) if node}
    for id in settings.overrides:
        if id not in known:
            yield f"{_quoted(id)} cannot be overridden"


def _plan_problems(plan: Plan) -> Iterator[str]:
    """Yield what would keep a guard from running under a plan, or the plan from meaning it."""
    for grcn in plan.grcn:
        yield from _grcn(grcn)
    if plan.rsrcn:
        yield from _rsrcn(plan.rsrcn, plan)
    if plan.msrcn:
        yield from _msrcn(plan.msrcn)


def _grcn(grcn: GRCN) -> Iterator[str]:
    yield from _policy(grcn.id, grcn.policy, _GRCN_POLICIES)
    if grcn.sharing is Sharing.MERGE:
        yield from _policy(grcn.id, grcn.policy, (PolicyName.BLOCK,))
    if grcn.policy in _PRIORITY_POLICIES:
        yield from _order(grcn.id, grcn.flows)


def _rsrcn(rsrcn: RSRCN, plan: Plan) -> Iterator[str]:
    yield from _policy(rsrcn.id, rsrcn.policy, _RSRCN_POLICIES)
    if rsrcn.policy in _VELOCITY_LIMIT_POLICIES and rsrcn.max_vel_limit is None:
        yield f"{rsrcn.id}: {rsrcn.policy} needs max_vel_limit"
    if rsrcn.policy in _FRAME_RATE_POLICIES:
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
    if len(msrcn.rules) > MAX_RULES:
        yield f"{msrcn.id}: more than {MAX_RULES} rules"
    topics = {topic.topic: {flow.name for flow in topic.flows} for topic in msrcn.aflows}
    flows = {name: {name} for names in topics.values() for name in names}
    for rule in msrcn.rules:
        yield from (f"rule {rule.name}: {problem}" for problem in _blocks(rule, topics | flows))


def _blocks(rule: MissionRule, flows: dict[str, set[str]]) -> Iterator[str]:
    """Yield what is wrong with what a rule blocks; `flows` are those of each flow and topic."""
    for name in rule.block:
        if name not in flows:
            yield f"it blocks no aflow or topic that is called {_quoted(name)}"
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


def _quoted(name: str) -> str:
    return repr(name[:MAX_NAME_LENGTH])
