"""The expressions of a plan, checked before anything uses it: the guard refuses what is wrong."""

from collections.abc import Iterator, Sequence

from rtron.errors import InputError
from rtron.messages.common.definition_registry import Definitions
from rtron.messages.expressions.condition import Condition
from rtron.messages.expressions.evaluator import check_expression
from rtron.planning.coherence.msrcn import (
    MOST_EFLOWS,
    MOST_EXPRESSIONS,
    MOST_RULES,
    blocked_types,
)
from rtron.planning.coherence.required_flows import self_met
from rtron.planning.coherence.rule_contradictions import contradictions
from rtron.planning.problem import Level
from rtron.vocabulary import MSRCN, EventFlow, MessageDefinition, Plan, Rule

Fault = tuple[object, str, InputError]
"""A noun, its key, and what is wrong with it; the error's help says what to do about it."""


def expression_faults(plan: Plan) -> Iterator[Fault]:
    """Yield what is wrong with message definitions, expressions, and the rules as a whole."""
    definitions = Definitions(plan.messages, ros=plan.ros)
    for message in plan.messages:
        yield from _definition(message, definitions)
    if plan.msrcn is None:
        return
    for flow in [flow for flow in plan.msrcn.eflows if flow.when][:MOST_EXPRESSIONS]:
        yield from _event(flow, plan.msrcn, definitions)
    for rule in plan.msrcn.rules[:MOST_RULES]:
        yield from _action(rule, plan.msrcn, definitions)
    yield from _rules(plan.msrcn)


def doubts(msrcn: MSRCN) -> Iterator[tuple[str, str]]:
    """Yield what may be meant although it looks odd: the rule's name, and what is odd."""
    conditions, _ = _conditions(msrcn)
    for level, rule, told in contradictions(msrcn, conditions):
        if level is Level.WARNING:
            yield rule.name, told


def _rules(msrcn: MSRCN) -> Iterator[Fault]:
    conditions, wrong = _conditions(msrcn)
    yield from wrong
    for rule in msrcn.rules:
        if rule.require and rule.name in conditions:
            asked = conditions[rule.name].names
            for noun, key, told in self_met(rule, asked, msrcn.eflows[:MOST_EFLOWS]):
                yield noun, key, InputError(told)
    for level, rule, told in contradictions(msrcn, conditions):
        if level is Level.ERROR:
            yield rule, "when", InputError(told)


def _definition(message: MessageDefinition, definitions: Definitions) -> Iterator[Fault]:
    try:
        definitions.find(message.type)
    except InputError as error:
        yield message, "definition", error


def _event(flow: EventFlow, msrcn: MSRCN, definitions: Definitions) -> Iterator[Fault]:
    if flow.type:
        yield from _expression(flow, "when", flow.type, msrcn, definitions)
    else:
        told = "the type is needed to check the expression"
        yield flow, "when", InputError(told, help="give the eflow's `type`")


def _action(rule: Rule, msrcn: MSRCN, definitions: Definitions) -> Iterator[Fault]:
    types = blocked_types(rule, msrcn) if rule.action else set()
    if len(types) == 1 and types != {""}:
        yield from _expression(rule, "action", types.pop(), msrcn, definitions)


def _expression(
    noun: EventFlow | Rule, key: str, message_type: str, msrcn: MSRCN, definitions: Definitions
) -> Iterator[Fault]:
    try:
        definition = definitions.find(message_type)
    except InputError as error:
        if not definitions.defines(message_type):
            yield noun, key, _under(key, error)
        return  # the plan's own is told there
    if definition is None:
        yield noun, key, _unknown(key, message_type, definitions.ros)
        return
    text, subject = (noun.when, "event") if isinstance(noun, EventFlow) else (noun.action, key)
    try:
        check_expression(definition, text, subject, msrcn.areas, frame=noun.frame)
    except InputError as error:
        yield noun, key, _under(key, error)


def _unknown(key: str, type: str, ros: int) -> InputError:
    from_source = "source the workspace that has it, or add its text under `messages`"
    from_master = f"add it under `messages`, as `rosmsg show -r {type}` prints it"
    told = f"{key}: RTron does not know the type {type}"
    return InputError(told, help=from_master if ros == 1 else from_source)


def _conditions(msrcn: MSRCN) -> tuple[dict[str, Condition], list[Fault]]:
    """Return the conditions of the rules by name, and what is wrong with the others."""
    names = [flow.name for flow in msrcn.eflows[:MOST_EFLOWS]]
    found: dict[str, Condition] = {}
    wrong: list[Fault] = []
    for rule in msrcn.rules[:MOST_RULES]:
        condition = _condition(rule, names)
        if isinstance(condition, InputError):
            wrong.append((rule, "when", _under("when", condition)))
        else:
            found[rule.name] = condition
    return found, wrong


def _condition(rule: Rule, names: Sequence[str]) -> Condition | InputError:
    try:
        return Condition(rule.when, names)
    except InputError as error:
        return error


def _under(key: str, error: InputError) -> InputError:
    """Return an error that names the key which holds the expression, with its own help."""
    return InputError(f"{key}: {error}", help=error.help)
