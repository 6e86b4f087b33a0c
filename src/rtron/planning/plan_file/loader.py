"""The plan file `rtron.yaml`, read and checked as a whole before anything uses it."""

import re
from collections.abc import Iterable, Mapping
from enum import Enum
from pathlib import Path
from typing import Any, TypeVar

import yaml

from rtron.coherence import coherence_problems
from rtron.errors import InputError, PlanError, suggestion
from rtron.planning.plan_file.defaults import with_defaults
from rtron.planning.plan_file.fields import PLAN_TYPES, PlanField, plan_fields
from rtron.planning.plan_file.problems import FileProblems, quoted
from rtron.planning.plan_file.quantities import parse_duration, write_duration
from rtron.vocabulary import Plan
from rtron.yaml_safety import YamlRules, compose_yaml

_NO_DEFINITIONS: Mapping[str, str] = {}


def read_plan(path: Path, recorded_definitions: Mapping[str, str] = _NO_DEFINITIONS) -> Plan:
    """Read a plan; raise one PlanError that tells all that is wrong, each with file and line.

    `recorded_definitions` are definitions by their types, which a recording brings: in a plan for
    ROS 2 those count that its expressions need and that nothing else defines.
    """
    return parse_plan(read_text(path), str(path), recorded_definitions)


def parse_plan(
    text: str, path: str = "rtron.yaml", recorded_definitions: Mapping[str, str] = _NO_DEFINITIONS
) -> Plan:
    """Read a plan from its text; `path` is what the errors call it."""
    problems = FileProblems(path)
    decoder = PlanDecoder(problems)
    plan = decoder.decode(parse_yaml(text, path), Plan) or Plan(app="")
    if recorded_definitions and plan.ros != 1 and has_expressions(plan):
        plan = _with_recorded_definitions(plan, recorded_definitions)
    for part, key, message in coherence_problems(plan):
        problems.add(decoder.line(part, key), message)
    for part, key, error in _expression_problems(plan):
        problems.add(decoder.line(part, key), str(error), error.help)
    problems.raise_if_any()
    return plan


def has_expressions(plan: Plan) -> bool:
    """Tell whether a plan has expressions, or definitions for them."""
    events = plan.msrcn.eflows if plan.msrcn else ()
    rules = plan.msrcn.rules if plan.msrcn else ()
    return bool(plan.messages or rules or any(flow.when for flow in events))


def _expression_problems(plan: Plan) -> Iterable[tuple[object, str, InputError]]:
    if not has_expressions(plan):
        return ()
    from rtron.planning.expressions import expression_problems  # noqa: PLC0415 - seldom needed

    return expression_problems(plan)


def _with_recorded_definitions(plan: Plan, definitions: Mapping[str, str]) -> Plan:
    from rtron.planning.expressions import with_recorded_definitions  # noqa: PLC0415 - only a replay needs it

    return with_recorded_definitions(plan, definitions)


T = TypeVar("T")
_INTEGER = re.compile(r"-?(0|[1-9][0-9]{0,18})")
_BOOLEANS = {"true": True, "false": False}
_TAG = "tag:yaml.org,2002:"


class _Invalid:
    """Stands for a value that was wrong and has been noted."""


class PlanDecoder:
    """Reads nouns as `form` describes them, and remembers on which line each key stands."""

    def __init__(self, problems: FileProblems) -> None:
        self.problems = problems
        self._lines: dict[tuple[int, str], int] = {}
        self._decoded: list[object] = []

    def line(self, part: object, key: str = "") -> int:
        """Return the line of a noun that was read here, or of one of its keys."""
        return self._lines.get((id(part), key)) or self._lines.get((id(part), ""), 0)

    def decode(self, node: yaml.Node, plan_type: type[T]) -> T | None:
        """Return the noun in a mapping, without what is wrong; None if too little is left."""
        entries = self._entries(node, plan_type)
        fields = plan_fields(plan_type)
        values = {name: self._value(value, fields[name]) for name, (_, value) in entries.items()}
        values = {name: value for name, value in values.items() if not isinstance(value, _Invalid)}
        required = [key.name for key in fields.values() if key.is_required]
        absent = [name for name in required if name not in entries]
        if absent and isinstance(node, yaml.MappingNode):
            self._add_problem(node, f"{PLAN_TYPES[plan_type]} needs {' and '.join(absent)}")
        if not values.keys() >= set(required):
            return None
        part = plan_type(**with_defaults(plan_type, values))
        self._store_lines(part, node, entries)
        return part

    def _store_lines(
        self, part: object, node: yaml.Node, entries: dict[str, tuple[yaml.Node, yaml.Node]]
    ) -> None:
        self._decoded.append(part)
        self._lines[id(part), ""] = node.start_mark.line + 1
        for name, (key, _) in entries.items():
            self._lines[id(part), name] = key.start_mark.line + 1

    def _entries(self, node: yaml.Node, plan_type: type) -> dict[str, tuple[yaml.Node, yaml.Node]]:
        if not isinstance(node, yaml.MappingNode):
            self._add_problem(
                node,
                f"{PLAN_TYPES[plan_type]} is a mapping with {', '.join(plan_fields(plan_type))}",
            )
            return {}
        entries: dict[str, tuple[yaml.Node, yaml.Node]] = {}
        for key, value in node.value:
            name = key.value if isinstance(key, yaml.ScalarNode) else ""
            if name not in plan_fields(plan_type):
                near = suggestion(name, plan_fields(plan_type))
                self._add_problem(
                    key, f"unknown key {quoted(name)} in {PLAN_TYPES[plan_type]}: {near}"
                )
            elif name in entries:
                self._add_problem(key, f"{name} stands twice in {PLAN_TYPES[plan_type]}")
            else:
                entries[name] = (key, value)
        return entries

    def _value(self, node: yaml.Node, key: PlanField) -> Any:  # noqa: ANN401 - as the key says
        if not key.is_list:
            return self._item(node, key)
        if not isinstance(node, yaml.SequenceNode):
            self._add_problem(node, f"{key.name} is a list: write `- …` lines or [ … ]")
            return _Invalid()
        if key.if_empty and not node.value:
            self._add_problem(node, f"{key.name} is empty: {key.if_empty}")
        items = (self._item(item, key) for item in node.value)
        return tuple(item for item in items if not isinstance(item, _Invalid))

    def _item(self, node: yaml.Node, key: PlanField) -> Any:  # noqa: ANN401 - as the key says
        if key.is_optional and node.tag == _TAG + "null":
            return None
        if key.item_type in PLAN_TYPES:
            part = self.decode(node, key.item_type)
            return _Invalid() if part is None else part
        if not isinstance(node, yaml.ScalarNode):
            self._add_problem(node, f"{key.name} is a single value")
            return _Invalid()
        try:
            return _scalar(node, key)
        except ValueError as error:
            self._add_problem(node, f"{key.name}: {error}")
            return _Invalid()

    def _add_problem(self, node: yaml.Node, message: str) -> None:
        self.problems.add(node.start_mark.line + 1, message)


def _scalar(node: yaml.ScalarNode, key: PlanField) -> Any:  # noqa: ANN401 - as the key says
    if key.is_duration:
        return _duration(node.value, key.range)
    if key.quantity:
        return key.quantity.parse(node.value)
    if key.item_type is bool:
        return _boolean(node.value)
    if key.item_type is int:
        return _integer(node.value, key.range)
    if issubclass(key.item_type, Enum):
        return _word(node.value, key.item_type)
    return _text(node, key)


def _duration(text: str, limits: tuple[int, int]) -> int:
    least, greatest = limits
    duration = parse_duration(text)
    if duration < least or duration > greatest:
        bounds = f"{write_duration(least)} and {write_duration(greatest)}"
        raise ValueError(f"{quoted(text)} is not between {bounds}")
    return duration


def _boolean(text: str) -> bool:
    if text.lower() not in _BOOLEANS:
        raise ValueError(f"{quoted(text)} is neither true nor false")
    return _BOOLEANS[text.lower()]


def _integer(text: str, limits: tuple[int, int]) -> int:
    least, greatest = limits
    if not _INTEGER.fullmatch(text):
        raise ValueError(f"{quoted(text)} is no whole number")
    if not least <= int(text) <= greatest:
        raise ValueError(f"{text} is not between {least} and {greatest}")
    return int(text)


def _word(text: str, words: type[Enum]) -> Enum:
    known = {str(word.value): word for word in words}
    if text not in known:
        raise ValueError(f"unknown word {quoted(text)}: {suggestion(text, known)}")
    return known[text]


def _text(node: yaml.ScalarNode, key: PlanField) -> str:
    if node.tag != _TAG + "str":
        raise ValueError(f"{quoted(node.value)} is no text: put it in quotes")
    if not key.text.matches(node.value):
        raise ValueError(f"{quoted(node.value)} is not {key.text.description}")
    return str(node.value)


MAX_BYTES = 2**20
_RULES = YamlRules(max_depth=20, allows_tags=False, refusal="a plan has no", error=PlanError)


def read_text(path: Path) -> str:
    """Return a plan's text; raise PlanError if it cannot be read or is too large."""
    try:
        with path.open("rb") as stream:
            data = stream.read(MAX_BYTES + 1)
        text = data.decode("utf-8")
    except OSError as error:
        why = error.strerror or "cannot be read"
        raise PlanError(why, path=str(path), help="`rtron plan` writes one") from None
    except UnicodeDecodeError:
        raise PlanError("not UTF-8 text", path=str(path)) from None
    if len(data) > MAX_BYTES:
        raise PlanError(f"larger than {MAX_BYTES} bytes", path=str(path))
    return text


def parse_yaml(text: str, path: str) -> yaml.Node:
    """Return the tree of a YAML text with its lines; raise PlanError if it is none or unsafe."""
    root = compose_yaml(text, path, _RULES)
    if root is None:
        raise PlanError("the plan is empty", path=path, help="`rtron plan` writes one")
    return root
