"""A change of settings, as people and programs give it, merged into the settings before it.

What is given replaces what was set, null takes it back to what the plan says. Durations are whole
numbers of ns, or texts with a unit as in the plan; other quantities are numbers in SI units, or
texts with a unit.
"""

from collections.abc import Collection, Mapping
from dataclasses import replace
from enum import Enum
from typing import Any, NoReturn, TypeVar

from rtron.errors import InputError
from rtron.planning.plan_file.durations import parse_duration, write_duration
from rtron.planning.plan_file.fields import Key, keys
from rtron.planning.plan_file.problems import shown, suggestion
from rtron.vocabulary import (
    GRCN,
    RSRCN,
    Flow,
    FlowSettings,
    NodeSettings,
    Plan,
    Rule,
    RuleSettings,
    Settings,
    coordination_ids,
)

T = TypeVar("T")
Patch = Mapping[str, Any]
MOST_OWN_RULES = 50
"""The most rules that the end user may add."""
MOST_BLOCKED = 1000
"""The most aflows and topics that one rule may block."""

_NODE: Mapping[str, Key] = {
    **{name: keys(GRCN)[name] for name in ("policy", "release_after", "max_age", "max_hold")},
    **{name: keys(RSRCN)[name] for name in ("threshold", "max_vel_limit")},
}
_FLOW: Mapping[str, Key] = {name: keys(Flow)[name] for name in ("priority", "block", "timeout")}
_SELECTED = Key(name="selected", item=bool, many=False, optional=True, required=False, default=None)
_RULE: Mapping[str, Key] = {
    "selected": _SELECTED,
    **{name: keys(Rule)[name] for name in ("block", "when")},
}
_RULE_NAME = keys(Rule)["name"].text


def merged(plan: Plan, before: Settings, nodes: Mapping[str, Patch]) -> Settings:
    """Return the settings with a change merged in, their revision as it was.

    InputError, with the nearest word, for what is unknown, and for values that are none.
    """
    after = dict(before.nodes)
    for id, patch in nodes.items():
        _known(id, coordination_ids(plan), "coordination node")
        after[id] = _node(id, after.get(id, NodeSettings()), patch)
    _count_own(plan, after)
    return replace(before, nodes=_told(after, NodeSettings()))


def _node(id: str, before: NodeSettings, patch: Patch) -> NodeSettings:
    for name in patch:
        _known(name, [*_NODE, "flows", "rules"], f"setting of {id}")
    plain = {name: value for name, value in patch.items() if name in _NODE}
    node = _merge(id, before, plain, _NODE)
    if "flows" in patch:
        node = replace(node, flows=_flows(id, before.flows, patch["flows"]))
    if "rules" in patch:
        node = replace(node, rules=_rules(id, before.rules, patch["rules"]))
    return node


def _flows(
    id: str, before: Mapping[str, FlowSettings], given: object
) -> Mapping[str, FlowSettings]:
    return _each(f"{id}.flows", before, given, FlowSettings(), _FLOW)


def _rules(
    id: str, before: Mapping[str, RuleSettings], given: object
) -> Mapping[str, RuleSettings]:
    rules = _each(f"{id}.rules", before, given, RuleSettings(), _RULE)
    for name in rules:
        if not _RULE_NAME.fits(name):
            raise InputError(f"{id}.rules: {shown(name)} is not {_RULE_NAME.words}")
    return rules


def _each(
    where: str, before: Mapping[str, T], given: object, none: T, form: Mapping[str, Key]
) -> Mapping[str, T]:
    """Merge flows or rules, each by its name; null takes one of them back, or all."""
    if given is None:
        return {}
    after = dict(before)
    for name, patch in _mapping(where, given).items():
        place = f"{where}.{shown(name)[1:-1]}"
        if patch is None:
            after[name] = none
        else:
            after[name] = _merge(place, after.get(name, none), _mapping(place, patch), form)
    return _told(after, none)


def _merge(where: str, before: T, patch: Patch, form: Mapping[str, Key]) -> T:
    for name in patch:
        _known(name, form, f"setting of {where}")
    values = {name: _value(f"{where}.{name}", value, form[name]) for name, value in patch.items()}
    return replace(before, **values)  # type: ignore[type-var]


def _told(items: Mapping[str, T], none: T) -> dict[str, T]:
    """Leave out what differs in nothing from the plan."""
    return {name: item for name, item in items.items() if item != none}


def _mapping(where: str, value: object) -> Mapping[str, Any]:
    if not isinstance(value, dict):
        raise InputError(f"{where} is an object", help=f"{_last(where)}: {{name: …}}, or null")
    return value


def _last(where: str) -> str:
    return where.rpartition(".")[2]


def _known(name: str, known: Collection[str], what: str) -> None:
    if name not in known:
        raise InputError(f"no {what} is called {shown(name)}", help=suggestion(name, known))


def _count_own(plan: Plan, nodes: Mapping[str, NodeSettings]) -> None:
    planned = {rule.name for rule in plan.msrcn.rules} if plan.msrcn else set()
    own = [name for node in nodes.values() for name in node.rules if name not in planned]
    if len(own) > MOST_OWN_RULES:
        help = "delete some, or put them into the plan"
        raise InputError(f"more than {MOST_OWN_RULES} rules of your own", help=help)


def _value(where: str, value: object, key: Key) -> Any:  # noqa: ANN401 - as the key says
    if value is None:
        return None
    try:
        return _many(value, key) if key.many else _one(value, key)
    except ValueError as error:
        raise InputError(f"{where}: {error}") from None


def _many(value: object, key: Key) -> tuple[Any, ...]:
    if not isinstance(value, list) or not value:
        raise ValueError("a list of at least one aflow or topic")
    if len(value) > MOST_BLOCKED:
        raise ValueError(f"more than {MOST_BLOCKED} of them")
    return tuple(dict.fromkeys(_one(item, key) for item in value))


def _one(value: object, key: Key) -> Any:  # noqa: ANN401 - as the key says
    if key.duration:
        return _duration(value, key.range)
    if key.quantity:
        return _positive(key.quantity.parse(value if isinstance(value, str) else repr(value)))
    if key.item is bool:
        return value if isinstance(value, bool) else _refuse(value, "neither true nor false")
    if key.item is int:
        return _whole(value, key.range)
    if not isinstance(value, str):
        return _refuse(value, "no text")
    return _word(value, key.item) if issubclass(key.item, Enum) else _text(value, key)


def _duration(value: object, limits: tuple[int, int]) -> int:
    if isinstance(value, bool) or not isinstance(value, (int, str)):
        _refuse(value, "no duration: write a whole number of ns, or a unit, like 200 ms")
    duration = value if isinstance(value, int) else parse_duration(value)
    least, greatest = limits
    if not least <= duration <= greatest:
        raise ValueError(f"not between {write_duration(least)} and {write_duration(greatest)}")
    return duration


def _positive(number: float) -> float:
    if number <= 0:
        raise ValueError("0 would stop the robot: use a block bit or the emergency stop")
    return number


def _whole(value: object, limits: tuple[int, int]) -> int:
    if isinstance(value, bool) or not isinstance(value, int):
        _refuse(value, "no whole number")
    least, greatest = limits
    return value if least <= value <= greatest else _refuse(value, f"not {least} to {greatest}")


def _text(value: str, key: Key) -> str:
    return value if key.text.fits(value) else _refuse(value, f"not {key.text.words}")


def _refuse(value: object, what: str) -> NoReturn:
    raise ValueError(f"{_said(value)} is {what}")


def _said(value: object) -> str:
    if isinstance(value, (dict, list)):
        return "an object" if isinstance(value, dict) else "a list"
    return shown(value if isinstance(value, str) else repr(value))


def _word(value: str, words: type[Enum]) -> Enum:
    known = {str(word.value): word for word in words}
    if value not in known:
        raise ValueError(f"unknown word {shown(value)}: {suggestion(value, known)}")
    return known[value]
