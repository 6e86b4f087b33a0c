"""The definitions that a recording brings for a plan's expressions, as if the plan had them."""

from collections.abc import Iterator, Mapping
from dataclasses import replace

from rtron.errors import InputError
from rtron.messages.common.definition_parser import parse_definition
from rtron.messages.common.definition_registry import DefinitionRegistry
from rtron.planning.coherence.msrcn import MAX_EXPRESSIONS, MAX_RULES, blocked_types
from rtron.vocabulary import MSRCN, MessageDefinition, Plan, is_action_type, normalise_type


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
