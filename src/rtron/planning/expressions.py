"""The expressions of a plan, checked before anything uses it: the guard refuses what is wrong."""

import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

from rtron.coherence.duration_bounds import MAX_RULES
from rtron.coherence.flows import self_fulfilling_problems
from rtron.coherence.msrcn import MAX_EFLOWS, MAX_EXPRESSIONS, blocked_types
from rtron.errors import InputError
from rtron.messages.common.definition import Definition
from rtron.messages.common.definition_parser import parse_definition
from rtron.messages.common.definition_registry import DefinitionRegistry
from rtron.messages.common.velocity import VELOCITY_TYPES
from rtron.messages.expressions.condition import Condition
from rtron.messages.expressions.constant_check import MAX_STEPS, constant_value
from rtron.messages.expressions.evaluator import check_expression
from rtron.planning.problem import ProblemLevel
from rtron.planning.rule_contradictions import Contradiction, contradictions
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


_DIFFERS_FROM_ITSELF = re.compile(r"(?<![\w.])(\w[\w.\[\]]*)\s*!=\s*\1(?![\w.\[(])")


@dataclass(frozen=True, slots=True)
class CheckedExpressions:
    """What was found out about a plan's expressions.

    `conditions` are those of the rules that are in order, by name; `always` are the eflows and
    rules whose expression holds for every message.
    """

    problems: tuple[ExpressionProblem, ...]
    conditions: Mapping[str, Condition]
    contradictions: tuple[Contradiction, ...]
    always: tuple[EventFlow | MissionRule, ...]


def expression_problems(plan: Plan) -> tuple[ExpressionProblem, ...]:
    """Return what is wrong with message definitions, expressions, and the rules as a whole."""
    return check_expressions(plan).problems


def check_expressions(plan: Plan) -> CheckedExpressions:
    """Check all expressions of a plan, with the types that are installed now."""
    definitions = DefinitionRegistry(plan.messages, ros=plan.ros)
    problems = [each for message in plan.messages for each in _definition(message, definitions)]
    msrcn = plan.msrcn
    if msrcn is None:
        return CheckedExpressions(tuple(problems), {}, (), ())
    checker = _ExpressionChecker(msrcn, definitions)
    problems += checker.problems()
    conditions, faults = _conditions(msrcn)
    found = tuple(contradictions(msrcn, conditions))
    problems += [*faults, *_self_fulfilling(msrcn, conditions)]
    problems += [
        (rule, "when", InputError(message))
        for level, rule, message in found
        if level is ProblemLevel.ERROR
    ]
    return CheckedExpressions(tuple(problems), conditions, found, tuple(checker.always))


def _self_fulfilling(
    msrcn: MSRCN, conditions: Mapping[str, Condition]
) -> Iterator[ExpressionProblem]:
    for rule in msrcn.rules:
        if rule.require and rule.name in conditions:
            names = conditions[rule.name].names
            for part, key, message in self_fulfilling_problems(
                rule, names, msrcn.eflows[:MAX_EFLOWS]
            ):
                yield part, key, InputError(message)


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


class _ExpressionChecker:
    """Checks the expressions of a mission over messages; `always` are those that always hold."""

    def __init__(self, msrcn: MSRCN, definitions: DefinitionRegistry) -> None:
        self._msrcn = msrcn
        self._definitions = definitions
        self._events = [flow for flow in msrcn.eflows if flow.when][:MAX_EXPRESSIONS]
        self._rules = [rule for rule in msrcn.rules[:MAX_RULES] if rule.action]
        self._steps = MAX_STEPS // max(1, len(self._events) + len(self._rules))
        self.always: list[EventFlow | MissionRule] = []

    def problems(self) -> Iterator[ExpressionProblem]:
        """Yield what is wrong with the expressions."""
        for flow in self._events:
            if flow.type:
                yield from self._expression(flow, "when", flow.when, flow.type)
            else:
                message = "the type is needed to check the expression"
                yield flow, "when", InputError(message, help="give the eflow's `type`")
        for rule in self._rules:
            types = blocked_types(rule, self._msrcn)
            if len(types) == 1 and types != {""}:
                yield from self._expression(rule, "action", rule.action, types.pop())

    def _expression(
        self, part: EventFlow | MissionRule, key: str, text: str, message_type: str
    ) -> Iterator[ExpressionProblem]:
        definitions, subject = self._definitions, "event" if key == "when" else key
        try:
            definition = definitions.find(message_type)
        except InputError as error:
            if not definitions.defines(message_type):
                yield part, key, _with_key(key, error)
            return  # the plan's own is told there
        if definition is None:
            yield part, key, _unknown_type(key, message_type, definitions.ros)
            return
        try:
            check_expression(definition, text, subject, self._msrcn.areas, frame=part.frame)
        except InputError as error:
            yield part, key, _with_key(key, error)
            return
        value = constant_value(text, definition, subject, self._steps)
        if value is False:
            yield part, key, _never_holds(part.name, key, text)
        elif value:
            self.always.append(part)


def _never_holds(name: str, key: str, text: str) -> InputError:
    what = f"{name} blocks nothing" if key == "action" else f"{name} is never 1"
    same = _DIFFERS_FROM_ITSELF.search(text)
    help = f"ask math.isNaN({same[1]})" if same else "correct what it compares, or leave it out"
    return InputError(f"{key}: {text} holds for no message: {what}", help=help)


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
