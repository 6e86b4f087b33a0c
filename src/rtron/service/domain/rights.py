"""Who may do what to which kind of coordination node (paper, table of policies, Executor column).

Selecting a policy and setting a parameter are separate rights. What the plan calls `mandatory`
nobody can take away here: only the plan can.
"""

from collections.abc import Collection, Iterator, Mapping

from rtron.planning.coherence.msrcn import flows_by_name
from rtron.planning.coherence.rsrcn import BY_LIMIT, BY_RATE, included
from rtron.service.domain.schemas import Right, UserRole
from rtron.vocabulary import (
    MSRCN,
    RSRCN,
    CoordinationKind,
    FlowSettings,
    NodeSettings,
    Plan,
    Rule,
    RuleSettings,
    Settings,
    coordination_ids,
    effective_plan,
)

NodeRight = tuple[str, Right]
"""The id of a coordination node, and a right that is needed there."""

_GRCN, _RSRCN, _MSRCN = CoordinationKind.GRCN, CoordinationKind.RSRCN, CoordinationKind.MSRCN
RIGHTS: Mapping[UserRole, Mapping[CoordinationKind, frozenset[Right]]] = {
    UserRole.DEVELOPER: {
        _GRCN: frozenset(
            {
                Right.SELECT_POLICY,
                Right.SET_PRIORITY,
                Right.SET_BLOCK,
                Right.SET_TIMEOUT,
                Right.SET_DURATIONS,
            }
        ),
        _RSRCN: frozenset(
            {Right.SET_BLOCK, Right.SET_THRESHOLD, Right.SET_PRIORITY, Right.OVERRIDE}
        ),
        _MSRCN: frozenset({Right.OVERRIDE}),
    },
    UserRole.END_USER: {
        _RSRCN: frozenset({Right.SELECT_POLICY, Right.SET_MAX_VEL_LIMIT, Right.OVERRIDE}),
        _MSRCN: frozenset(
            {
                Right.SELECT_POLICY,
                Right.SET_BLOCK,
                Right.SELECT_RULES,
                Right.SET_RULES,
                Right.OVERRIDE,
            }
        ),
    },
}
"""What is not here is nobody's; the emergency stop is every role's."""

_OF_NODE: Mapping[str, Right] = {
    "policy": Right.SELECT_POLICY,
    "release_after": Right.SET_DURATIONS,
    "max_age": Right.SET_DURATIONS,
    "max_hold": Right.SET_DURATIONS,
    "threshold": Right.SET_THRESHOLD,
    "max_vel_limit": Right.SET_MAX_VEL_LIMIT,
}
_OF_FLOW: Mapping[str, Right] = {
    "priority": Right.SET_PRIORITY,
    "block": Right.SET_BLOCK,
    "timeout": Right.SET_TIMEOUT,
}
_OF_RULE: Mapping[str, Right] = {
    "selected": Right.SELECT_RULES,
    "block": Right.SET_RULES,
    "when": Right.SET_RULES,
}


def rights(roles: Collection[UserRole], kind: CoordinationKind) -> frozenset[Right]:
    """Return what somebody with these roles may do to such coordination nodes."""
    found = (RIGHTS.get(role, {}).get(kind, frozenset()) for role in roles)
    return frozenset[Right]().union(*found)


def kinds(plan: Plan) -> dict[str, CoordinationKind]:
    """Return the kind of each coordination node that has a policy, by id."""
    found = {grcn.id: _GRCN for grcn in plan.grcn}
    found |= {plan.rsrcn.id: _RSRCN} if plan.rsrcn else {}
    return found | ({plan.msrcn.id: _MSRCN} if plan.msrcn else {})


def needed_rights(plan: Plan, before: Settings, after: Settings) -> set[NodeRight]:
    """Return the rights that it takes to make `after` of `before`; nodes as the plan has them.

    Overrides and the emergency stop are asked for on their own.
    """
    none = NodeSettings()
    return {
        (id, right)
        for id in coordination_ids(plan)
        for right in _needed(before.nodes.get(id, none), after.nodes.get(id, none))
    }


def missing_rights(
    plan: Plan, roles: Collection[UserRole], needed: Collection[NodeRight]
) -> list[NodeRight]:
    """Return those of the needed rights that the roles do not give, in a steady order."""
    known = kinds(plan)
    return sorted((id, right) for id, right in needed if right not in rights(roles, known[id]))


def mandatory_breaches(plan: Plan, settings: Settings) -> Iterator[str]:
    """Yield what settings take away from that which the plan makes mandatory.

    The settings fit the plan: MisfitError otherwise.
    """
    after = effective_plan(plan, settings)
    if plan.rsrcn and after.rsrcn:
        yield from _limits(plan.rsrcn, after.rsrcn)
    if plan.msrcn and after.msrcn:
        for rule in plan.msrcn.rules:
            if rule.mandatory:
                yield from _rule(rule, after.msrcn)


def _needed(before: NodeSettings, after: NodeSettings) -> Iterator[Right]:
    yield from _differing(_OF_NODE, before, after)
    for name in before.flows.keys() | after.flows.keys():
        yield from _differing(
            _OF_FLOW,
            before.flows.get(name, FlowSettings()),
            after.flows.get(name, FlowSettings()),
        )
    for name in before.rules.keys() | after.rules.keys():
        yield from _differing(
            _OF_RULE,
            before.rules.get(name, RuleSettings()),
            after.rules.get(name, RuleSettings()),
        )


def _differing(table: Mapping[str, Right], before: object, after: object) -> Iterator[Right]:
    return (right for key, right in table.items() if getattr(before, key) != getattr(after, key))


def _limits(plan: RSRCN, after: RSRCN) -> Iterator[str]:
    if plan.mandatory is None:
        return
    if plan.mandatory not in included(after.policy):
        yield f"{plan.mandatory} of {plan.id} is mandatory: {after.policy} would deselect it"
    told = f"{plan.mandatory} of {plan.id} is mandatory"
    if plan.mandatory in BY_LIMIT and _is_raised(plan.max_vel_limit, after.max_vel_limit):
        yield f"{told}: max_vel_limit is at most {plan.max_vel_limit:g} m/s"
    if plan.mandatory in BY_RATE and _is_raised(plan.threshold, after.threshold):
        yield f"{told}: threshold is at most {plan.threshold:g} m/frame"


def _is_raised(most: float | None, after: float | None) -> bool:
    return most is not None and after is not None and after > most


def _rule(rule: Rule, after: MSRCN) -> Iterator[str]:
    """Compare a mandatory rule with what is left: its condition stays, bits are only added."""
    left = next((each for each in after.rules if each.name == rule.name), None)
    told = f"the rule {rule.name} of {after.id} is mandatory"
    if left is None:
        yield f"{told}: it cannot be deselected"
    elif left.when != rule.when:
        yield f"{told}: its condition stays as the plan says"
    elif not _blocked(rule, after) <= _blocked(left, after):
        yield f"{told}: what it blocks stays blocked"


def _blocked(rule: Rule, msrcn: MSRCN) -> frozenset[str]:
    known = flows_by_name(msrcn)
    return frozenset[str]().union(*(known.get(name, frozenset({name})) for name in rule.block))
