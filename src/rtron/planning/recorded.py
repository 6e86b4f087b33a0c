"""The definitions that a recording brings for a plan's expressions, as if the plan had them."""

from collections.abc import Iterator, Mapping
from dataclasses import replace

from rtron.errors import InputError
from rtron.messages.common.definition_parser import parse_definition
from rtron.messages.common.definition_registry import Definitions
from rtron.planning.coherence.msrcn import MOST_EXPRESSIONS, MOST_RULES, blocked_types
from rtron.vocabulary import MSRCN, MessageDefinition, Plan, is_action_type, normalise_type


def with_recorded(plan: Plan, recorded: Mapping[str, str]) -> Plan:
    """Return a plan with the definitions of types that its expressions ask for and nobody defines.

    What is no definition of its type is left out.
    """
    known = Definitions(plan.messages, ros=plan.ros)
    texts = {normalise_type(type): text for type, text in recorded.items()}
    asked = dict.fromkeys(_asked(plan.msrcn)) if plan.msrcn else ()
    more = tuple(
        MessageDefinition(type=type, definition=texts[type])
        for type in asked
        if type in texts and not _is_known(type, known) and _defines(type, texts[type])
    )
    return replace(plan, messages=(*plan.messages, *more))


def _asked(msrcn: MSRCN) -> Iterator[str]:
    """Yield the types whose messages expressions look into, in our spelling."""
    for flow in [flow for flow in msrcn.eflows if flow.when][:MOST_EXPRESSIONS]:
        yield normalise_type(flow.type)
    for rule in [rule for rule in msrcn.rules[:MOST_RULES] if rule.action]:
        yield from sorted(blocked_types(rule, msrcn))


def _is_known(type: str, known: Definitions) -> bool:
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
