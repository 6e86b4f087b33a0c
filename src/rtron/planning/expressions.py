"""The expressions of a plan, checked before anything uses it: the guard refuses what is wrong."""

from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import replace

from rtron.coherence.msrcn import (
    MAX_EFLOWS,
    MAX_EXPRESSIONS,
    blocked_types,
)
from rtron.coherence.required_flows import self_fulfilling_problems
from rtron.coherence.settings_bounds import MAX_RULES
from rtron.errors import InputError
from rtron.messages.common.definition import Definition
from rtron.messages.common.definition_parser import parse_definition
from rtron.messages.common.definition_registry import DefinitionRegistry
from rtron.messages.common.velocity import VELOCITY_TYPES
from rtron.messages.expressions.condition import Condition
from rtron.messages.expressions.constant_check import constant_value
from rtron.messages.expressions.evaluator import check_expression
from rtron.planning.mission_gaps import mission_gaps
from rtron.planning.problem import ProblemLevel
from rtron.planning.rule_contradictions import contradictions
from rtron.vocabulary import (
    MSRCN,
    EventFlow,
    MessageDefinition,
    MissionRule,
    Plan,
    is_action_type,
    normalise_type,
)

ExpressionProblem = tuple[object, str, InputError]
"""A noun, its key, and what is wrong with it; the error's help says what to do about it."""


def expression_problems(plan: Plan) -> Iterator[ExpressionProblem]:
    """Yield what is wrong with message definitions, expressions, and the rules as a whole."""
    definitions = DefinitionRegistry(plan.messages, ros=plan.ros)
    for message in plan.messages:
        yield from _definition(message, definitions)
    if plan.msrcn is None:
        return
    for flow in [flow for flow in plan.msrcn.eflows if flow.when][:MAX_EXPRESSIONS]:
        yield from _event(flow, plan.msrcn, definitions)
    for rule in plan.msrcn.rules[:MAX_RULES]:
        yield from _action(rule, plan.msrcn, definitions)
    yield from _rules(plan.msrcn)


def rule_warnings(plan: Plan) -> Iterator[tuple[str, str]]:
    """Yield what may be meant although it looks odd: the rule or eflow, and what is odd."""
    msrcn = plan.msrcn
    if msrcn is None:
        return
    conditions, _ = _conditions(msrcn)
    for level, rule, message in contradictions(msrcn, conditions):
        if level is ProblemLevel.WARNING:
            yield f"rule {rule.name}", message
    yield from mission_gaps(plan, conditions)
    definitions = DefinitionRegistry(plan.messages, ros=plan.ros)
    for flow in [flow for flow in msrcn.eflows if flow.when][:MAX_EXPRESSIONS]:
        if _always_holds(flow.when, {flow.type}, "event", definitions):
            help = "leave `when` out, and say with `present` how long a message counts"
            yield flow.name, f"`when` holds for every message of {flow.topic}: {help}"
    for rule in [rule for rule in msrcn.rules[:MAX_RULES] if rule.action]:
        if _always_holds(rule.action, blocked_types(rule, msrcn), "action", definitions):
            yield f"rule {rule.name}", "`action` holds for every message: leave it out"


def _always_holds(
    text: str, types: Collection[str], subject: str, definitions: DefinitionRegistry
) -> bool:
    known = [definition for type in types if (definition := definitions.find(type))]
    return len(known) == 1 and constant_value(text, known[0], subject) is True


def _rules(msrcn: MSRCN) -> Iterator[ExpressionProblem]:
    conditions, problems = _conditions(msrcn)
    yield from problems
    for rule in msrcn.rules:
        if rule.require and rule.name in conditions:
            event_names = conditions[rule.name].names
            for part, key, message in self_fulfilling_problems(
                rule, event_names, msrcn.eflows[:MAX_EFLOWS]
            ):
                yield part, key, InputError(message)
    for level, rule, message in contradictions(msrcn, conditions):
        if level is ProblemLevel.ERROR:
            yield rule, "when", InputError(message)


def _definition(
    message: MessageDefinition, definitions: DefinitionRegistry
) -> Iterator[ExpressionProblem]:
    try:
        defined = definitions.find(message.type)
        is_velocity = normalise_type(message.type) in VELOCITY_TYPES
        known = DefinitionRegistry(ros=definitions.ros).find(message.type) if is_velocity else None
    except InputError as error:
        yield message, "definition", error
        return
    if is_velocity and not _is_same(defined, known):
        why = "no limit and no stop would read it as the robot does"
        text = f"{message.type} has other fields here than in ROS: {why}"
        yield message, "definition", InputError(text, help=f"leave {message.type} out")


def _is_same(one: Definition | None, other: Definition | None) -> bool:
    """Return whether two definitions have the same fields, those of their fields' types too."""
    if one is None or other is None:
        return one is other
    nested = one.nested.keys() | other.nested.keys()
    return one.fields == other.fields and all(
        _is_same(one.nested.get(type), other.nested.get(type)) for type in nested
    )


def _event(
    flow: EventFlow, msrcn: MSRCN, definitions: DefinitionRegistry
) -> Iterator[ExpressionProblem]:
    if flow.type:
        yield from _expression(flow, "when", flow.type, msrcn, definitions)
    else:
        message = "the type is needed to check the expression"
        yield flow, "when", InputError(message, help="give the eflow's `type`")


def _action(
    rule: MissionRule, msrcn: MSRCN, definitions: DefinitionRegistry
) -> Iterator[ExpressionProblem]:
    types = blocked_types(rule, msrcn) if rule.action else set()
    if len(types) == 1 and types != {""}:
        yield from _expression(rule, "action", types.pop(), msrcn, definitions)


def _expression(
    part: EventFlow | MissionRule,
    key: str,
    message_type: str,
    msrcn: MSRCN,
    definitions: DefinitionRegistry,
) -> Iterator[ExpressionProblem]:
    try:
        definition = definitions.find(message_type)
    except InputError as error:
        if not definitions.defines(message_type):
            yield part, key, _with_key(key, error)
        return  # the plan's own is told there
    if definition is None:
        yield part, key, _unknown_type(key, message_type, definitions.ros)
        return
    text, subject = (part.when, "event") if isinstance(part, EventFlow) else (part.action, key)
    try:
        check_expression(definition, text, subject, msrcn.areas, frame=part.frame)
    except InputError as error:
        yield part, key, _with_key(key, error)
        return
    if constant_value(text, definition, subject) is False:
        what = f"{part.name} blocks nothing" if key == "action" else f"{part.name} is never 1"
        message = f"{key}: {text} holds for no message: {what}"
        yield part, key, InputError(message, help="correct what it compares, or leave it out")


def _unknown_type(key: str, type: str, ros: int) -> InputError:
    from_source = "source the workspace that has it, or add its text under `messages`"
    from_master = f"add it under `messages`, as `rosmsg show -r {type}` prints it"
    message = f"{key}: RTron does not know the type {type}"
    return InputError(message, help=from_master if ros == 1 else from_source)


def _conditions(msrcn: MSRCN) -> tuple[dict[str, Condition], list[ExpressionProblem]]:
    """Return the conditions of the rules by name, and what is wrong with the others."""
    names = [flow.name for flow in msrcn.eflows[:MAX_EFLOWS]]
    conditions: dict[str, Condition] = {}
    problems: list[ExpressionProblem] = []
    for rule in msrcn.rules[:MAX_RULES]:
        condition = _condition(rule, names)
        if isinstance(condition, InputError):
            problems.append((rule, "when", _with_key("when", condition)))
        else:
            conditions[rule.name] = condition
    return conditions, problems


def _condition(rule: MissionRule, names: Sequence[str]) -> Condition | InputError:
    try:
        return Condition(rule.when, names)
    except InputError as error:
        return error


def _with_key(key: str, error: InputError) -> InputError:
    """Return an error that names the key which holds the expression, with its own help."""
    return InputError(f"{key}: {error}", help=error.help)


def with_recorded_definitions(plan: Plan, recorded_definitions: Mapping[str, str]) -> Plan:
    """Return a plan with the definitions of types that its expressions ask for and nobody defines.

    What is no definition of its type is left out.
    """
    known = DefinitionRegistry(plan.messages, ros=plan.ros)
    texts = {normalise_type(type): text for type, text in recorded_definitions.items()}
    needed_types = dict.fromkeys(_expression_types(plan.msrcn)) if plan.msrcn else ()
    more = tuple(
        MessageDefinition(type=type, definition=texts[type])
        for type in needed_types
        if type in texts and not _is_known(type, known) and _defines(type, texts[type])
    )
    return replace(plan, messages=(*plan.messages, *more))


def _expression_types(msrcn: MSRCN) -> Iterator[str]:
    """Yield the types whose messages expressions look into, in our spelling."""
    for flow in [flow for flow in msrcn.eflows if flow.when][:MAX_EXPRESSIONS]:
        yield normalise_type(flow.type)
    for rule in [rule for rule in msrcn.rules[:MAX_RULES] if rule.action]:
        yield from sorted(blocked_types(rule, msrcn))


def _is_known(type: str, known: DefinitionRegistry) -> bool:
    try:
        return known.find(type) is not None
    except InputError:
        return True


def _defines(type: str, text: str) -> bool:
    try:
        parse_definition(type, text)
    except InputError:
        return False
    return not is_action_type(type)
