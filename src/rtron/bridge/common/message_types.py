"""The message and service types that a bridge knows: those of the plan, installed and standard."""

import re
from collections.abc import Callable, Iterator

from rtron.bridge.common.plan_topics import topic_rights
from rtron.bridge.protocol.client_state import ActionDefinitions
from rtron.bridge.rights.document import BridgeRights
from rtron.errors import InputError, RTronError
from rtron.messages import Definition, DefinitionRegistry, Encoding, parse_definition
from rtron.messages.common.definition_registry import standard_text
from rtron.vocabulary import Plan, normalise_type

InterfaceText = Callable[[str, str], str]
"""Returns the text of a type, `pkg/Name`, of a kind, srv or action: parts with `---` between."""
_RULE = "=" * 80


class MessageTypes:
    """Finds definitions by their types; InputError or SourceError if a type is not known."""

    def __init__(self, plan: Plan, find_interface_text: InterfaceText) -> None:
        self.encoding = Encoding.ROS1 if plan.ros == 1 else Encoding.CDR
        self._plan = plan
        self._registry = DefinitionRegistry(plan.messages, ros=plan.ros)
        self._find_interface_text = find_interface_text
        self._actions: dict[str, ActionDefinitions] = {}
        self._services: dict[str, tuple[Definition, Definition]] = {}

    def message(self, type: str) -> Definition:
        """Return the definition of a message type."""
        found = self._registry.find(type)
        if found is None:
            help = "define it under `messages` of the plan, or install its package here"
            raise InputError(f"the type {type[:80]} is not known here", help=help)
        return found

    def text(self, type: str) -> str:
        """Return the text of a message type's definition, empty if only its parts are known."""
        name = normalise_type(type)
        own = (each.definition for each in self._plan.messages if each.type == name)
        return next(own, None) or standard_text(name, self._plan.ros) or ""

    def service(self, type: str) -> tuple[Definition, Definition]:
        """Return the definitions of a service's request and response."""
        name = type.replace("/srv/", "/", 1)
        if name not in self._services:
            text = self._find_interface_text(name, "srv")
            parts = _parts(name, text, ("Request", "Response"))
            request, response = (self._parse(each, part) for each, part in parts)
            self._services[name] = request, response
        return self._services[name]

    def action(self, type: str) -> ActionDefinitions:
        """Return the definitions of the parts of an action of ROS 2."""
        name = type.replace("/action/", "/", 1)
        if name not in self._actions:
            text = self._find_interface_text(name, "action")
            parts = _parts(name, text, ("_Goal", "_Result", "_Feedback"))
            (goal, goal_text), (result, result_text), (feedback, feedback_text) = parts
            answer = f"int8 status\n{result} result\n{_RULE}\nMSG: {result}\n{result_text}"
            self._actions[name] = ActionDefinitions(
                goal=self._parse(goal, goal_text),
                result=self._parse(f"{result}Answer", answer),
                feedback=self._parse(feedback, feedback_text),
            )
        return self._actions[name]

    def _parse(self, name: str, text: str) -> Definition:
        return parse_definition(name, text, lookup=self._registry.find)


def unknown_types(rights: BridgeRights, ros: int, types: MessageTypes) -> Iterator[str]:
    """Yield what clients have rights to and could not use: its type is not known."""
    for client in rights.clients:
        topics = topic_rights(client, ros)
        uses: list[tuple[str, Callable[[str], object], str]] = [
            *((each.topic, types.message, each.type) for each in topics),
            *((each.service, types.service, each.type) for each in client.call),
            *((each.action, types.action, each.type) for each in client.actions if ros != 1),
        ]
        problems = ((name, _type_problem(find, type)) for name, find, type in uses)
        yield from (f"{client.name}: {name}: {problem}" for name, problem in problems if problem)


def _type_problem(find: Callable[[str], object], type: str) -> str:
    try:
        find(type)
    except RTronError as error:
        return str(error)
    return ""


def _parts(name: str, text: str, endings: tuple[str, ...]) -> Iterator[tuple[str, str]]:
    """Yield the parts of an interface's text, between lines of `---`, each with its type."""
    parts = re.split(r"^---[ \t]*$", text, flags=re.MULTILINE)
    if len(parts) != len(endings):
        raise InputError(f"the definition of {name} has {len(parts)} parts, not {len(endings)}")
    for ending, part in zip(endings, parts, strict=True):
        yield f"{name}{ending}", part
