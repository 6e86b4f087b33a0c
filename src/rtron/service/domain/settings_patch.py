"""A change of settings, as people and programs give it, merged into the settings before it.

What is given replaces what was set, null takes it back to what the plan says. Durations are whole
numbers of ns, or texts with a unit as in the plan; other quantities are numbers in SI units, or
texts with a unit.
"""

from collections.abc import Collection, Mapping
from dataclasses import replace
from enum import Enum
from typing import Any, NoReturn, TypeVar

from rtron.coherence import coordination_node_ids
from rtron.errors import InputError, suggestion
from rtron.planning.plan_file.fields import PlanField, plan_fields
from rtron.planning.plan_file.problems import quoted
from rtron.planning.plan_file.quantities import parse_duration, write_duration
from rtron.vocabulary import (
    GRCN,
    RSRCN,
    Flow,
    FlowSettings,
    MissionRule,
    NodeSettings,
    Plan,
    RuleSettings,
    Settings,
)

T = TypeVar("T")
Patch = Mapping[str, Any]
MAX_USER_RULES = 50
"""The most rules that the end user may add."""
MAX_BLOCKED = 1000
"""The most aflows and topics that one rule may block."""

_NODE_KEYS: Mapping[str, PlanField] = {
    **{
        name: plan_fields(GRCN)[name] for name in ("policy", "release_after", "max_age", "max_hold")
    },
    **{name: plan_fields(RSRCN)[name] for name in ("threshold", "max_vel_limit")},
}
_FLOW_KEYS: Mapping[str, PlanField] = {
    name: plan_fields(Flow)[name] for name in ("priority", "block", "timeout")
}
_SELECTED_KEY = PlanField(
    name="selected",
    item_type=bool,
    is_list=False,
    is_optional=True,
    is_required=False,
    default=None,
)
_RULE_KEYS: Mapping[str, PlanField] = {
    "selected": _SELECTED_KEY,
    **{name: plan_fields(MissionRule)[name] for name in ("block", "when")},
}
_RULE_NAME = plan_fields(MissionRule)["name"].text


def merge_patch(plan: Plan, before: Settings, nodes: Mapping[str, Patch]) -> Settings:
    """Return the settings with a change merged in, their revision as it was.

    InputError, with the nearest word, for what is unknown, and for values that are none.
    """
    after = dict(before.nodes)
    for id, patch in nodes.items():
        _check_name(id, coordination_node_ids(plan), "coordination node")
        after[id] = _merge_node(id, after.get(id, NodeSettings()), patch)
    _check_rule_count(plan, after)
    return replace(before, nodes=_without_empty(after, NodeSettings()))


def _merge_node(id: str, before: NodeSettings, patch: Patch) -> NodeSettings:
    for name in patch:
        _check_name(name, [*_NODE_KEYS, "flows", "rules"], f"setting of {id}")
    scalars = {name: value for name, value in patch.items() if name in _NODE_KEYS}
    node = _merge_fields(id, before, scalars, _NODE_KEYS)
    if "flows" in patch:
        node = replace(node, flows=_merge_flows(id, before.flows, patch["flows"]))
    if "rules" in patch:
        node = replace(node, rules=_merge_rules(id, before.rules, patch["rules"]))
    return node


def _merge_flows(
    id: str, before: Mapping[str, FlowSettings], patches: object
) -> Mapping[str, FlowSettings]:
    return _merge_named(f"{id}.flows", before, patches, FlowSettings(), _FLOW_KEYS)


def _merge_rules(
    id: str, before: Mapping[str, RuleSettings], patches: object
) -> Mapping[str, RuleSettings]:
    rules = _merge_named(f"{id}.rules", before, patches, RuleSettings(), _RULE_KEYS)
    for name in rules:
        if not _RULE_NAME.matches(name):
            raise InputError(f"{id}.rules: {quoted(name)} is not {_RULE_NAME.description}")
    return rules


def _merge_named(
    location: str,
    before: Mapping[str, T],
    patches: object,
    empty: T,
    keys_by_name: Mapping[str, PlanField],
) -> Mapping[str, T]:
    """Merge flows or rules, each by its name; null takes one of them back, or all."""
    if patches is None:
        return {}
    after = dict(before)
    for name, patch in _check_mapping(location, patches).items():
        item_location = f"{location}.{quoted(name)[1:-1]}"
        if patch is None:
            after[name] = empty
        else:
            after[name] = _merge_fields(
                item_location,
                after.get(name, empty),
                _check_mapping(item_location, patch),
                keys_by_name,
            )
    return _without_empty(after, empty)


def _merge_fields(
    location: str, before: T, patch: Patch, keys_by_name: Mapping[str, PlanField]
) -> T:
    for name in patch:
        _check_name(name, keys_by_name, f"setting of {location}")
    values = {
        name: _parse_value(f"{location}.{name}", value, keys_by_name[name])
        for name, value in patch.items()
    }
    return replace(before, **values)  # type: ignore[type-var]


def _without_empty(items: Mapping[str, T], empty: T) -> dict[str, T]:
    """Leave out what differs in nothing from the plan."""
    return {name: item for name, item in items.items() if item != empty}


def _check_mapping(location: str, value: object) -> Mapping[str, Any]:
    if not isinstance(value, dict):
        raise InputError(
            f"{location} is an object", help=f"{_last_key(location)}: {{name: …}}, or null"
        )
    return value


def _last_key(location: str) -> str:
    return location.rpartition(".")[2]


def _check_name(name: str, names: Collection[str], kind: str) -> None:
    if name not in names:
        raise InputError(f"no {kind} is called {quoted(name)}", help=suggestion(name, names))


def _check_rule_count(plan: Plan, nodes: Mapping[str, NodeSettings]) -> None:
    planned = {rule.name for rule in plan.msrcn.rules} if plan.msrcn else set()
    user_rules = [name for node in nodes.values() for name in node.rules if name not in planned]
    if len(user_rules) > MAX_USER_RULES:
        help = "delete some, or put them into the plan"
        raise InputError(f"more than {MAX_USER_RULES} rules of your own", help=help)


def _parse_value(location: str, value: object, key: PlanField) -> Any:  # noqa: ANN401 - as the key says
    if value is None:
        return None
    try:
        return _parse_list(value, key) if key.is_list else _parse_item(value, key)
    except ValueError as error:
        raise InputError(f"{location}: {error}") from None


def _parse_list(value: object, key: PlanField) -> tuple[Any, ...]:
    if not isinstance(value, list) or not value:
        raise ValueError("a list of at least one aflow or topic")
    if len(value) > MAX_BLOCKED:
        raise ValueError(f"more than {MAX_BLOCKED} of them")
    return tuple(dict.fromkeys(_parse_item(item, key) for item in value))


def _parse_item(value: object, key: PlanField) -> Any:  # noqa: ANN401 - as the key says
    if key.is_duration:
        return _parse_duration_value(value, key.range)
    if key.quantity:
        return _check_positive(key.quantity.parse(value if isinstance(value, str) else repr(value)))
    if key.item_type is bool:
        return value if isinstance(value, bool) else _reject(value, "neither true nor false")
    if key.item_type is int:
        return _parse_integer(value, key.range)
    if not isinstance(value, str):
        return _reject(value, "no text")
    return (
        _parse_enum(value, key.item_type)
        if issubclass(key.item_type, Enum)
        else _check_text(value, key)
    )


def _parse_duration_value(value: object, limits: tuple[int, int]) -> int:
    if isinstance(value, bool) or not isinstance(value, (int, str)):
        _reject(value, "no duration: write a whole number of ns, or a unit, like 200 ms")
    duration = value if isinstance(value, int) else parse_duration(value)
    least, greatest = limits
    if not least <= duration <= greatest:
        raise ValueError(f"not between {write_duration(least)} and {write_duration(greatest)}")
    return duration


def _check_positive(number: float) -> float:
    if number <= 0:
        raise ValueError("0 would stop the robot: use a block bit or the emergency stop")
    return number


def _parse_integer(value: object, limits: tuple[int, int]) -> int:
    if isinstance(value, bool) or not isinstance(value, int):
        _reject(value, "no whole number")
    least, greatest = limits
    return value if least <= value <= greatest else _reject(value, f"not {least} to {greatest}")


def _check_text(value: str, key: PlanField) -> str:
    return value if key.text.matches(value) else _reject(value, f"not {key.text.description}")


def _reject(value: object, problem: str) -> NoReturn:
    raise ValueError(f"{_display(value)} is {problem}")


def _display(value: object) -> str:
    if isinstance(value, (dict, list)):
        return "an object" if isinstance(value, dict) else "a list"
    return quoted(value if isinstance(value, str) else repr(value))


def _parse_enum(value: str, enum: type[Enum]) -> Enum:
    members = {str(member.value): member for member in enum}
    if value not in members:
        raise ValueError(f"unknown word {quoted(value)}: {suggestion(value, members)}")
    return members[value]
