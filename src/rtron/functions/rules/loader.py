"""Loading the rules: one file per function type, and the lists of words that they share."""

from __future__ import annotations

from functools import cache
from importlib.resources import files
from typing import TYPE_CHECKING, Any

import yaml
from pydantic import ValidationError

from rtron.errors import InputError
from rtron.functions.patterns.index import PatternIndex
from rtron.functions.patterns.parser import parse
from rtron.functions.rules.form import WrittenRule, WrittenRules
from rtron.functions.rules.rule import Rule

if TYPE_CHECKING:
    from collections.abc import Mapping

    from rtron.functions.patterns.syntax_tree import Node
    from rtron.vocabulary import FunctionType

_DATA = files("rtron.functions.rules") / "data"
_WORDS = "words.yaml"


@cache
def rules() -> tuple[Rule, ...]:
    """Return every rule that RTron brings."""
    lists = read_lists((_DATA / _WORDS).read_text("utf-8"), _WORDS)
    names = sorted(file.name for file in _DATA.iterdir() if file.name.endswith(".yaml"))
    texts = ((name, (_DATA / name).read_text("utf-8")) for name in names if name != _WORDS)
    return tuple(rule for name, text in texts for rule in read_rules(text, name, lists))


@cache
def rule_index() -> PatternIndex[Rule]:
    """Return the patterns of every rule."""
    return PatternIndex((pattern, rule) for rule in rules() for pattern in rule.patterns)


def read_lists(text: str, path: str) -> Mapping[str, Node]:
    """Return the lists of words in a YAML text; raise InputError where one is wrong."""
    lists: dict[str, Node] = {}
    for name, written in _document(text, path).items():
        lists[str(name)] = _pattern(str(written), lists, path)
    return lists


def read_rules(text: str, path: str, lists: Mapping[str, Node]) -> tuple[Rule, ...]:
    """Return the rules in a YAML text; raise InputError where one is wrong."""
    try:
        written = WrittenRules.model_validate(_document(text, path))
    except ValidationError as error:
        first = error.errors()[0]
        place = ".".join(map(str, first["loc"]))
        raise InputError(f"{place}: {first['msg']}", path=path) from None
    return tuple(_rule(rule, written.type, lists, path) for rule in written.rules)


def _rule(rule: WrittenRule, type: FunctionType, lists: Mapping[str, Node], path: str) -> Rule:
    return Rule(
        id=rule.id,
        type=type,
        weight=rule.weight,
        patterns=tuple(_pattern(text, lists, path) for text in rule.patterns),
        pieces=frozenset(rule.pieces),
        vetoes=tuple(_pattern(text, lists, path) for text in rule.vetoes),
        matches=rule.matches,
        excludes=rule.excludes,
    )


def _pattern(text: str, lists: Mapping[str, Node], path: str) -> Node:
    try:
        return parse(text, lists)
    except InputError as error:
        raise InputError(str(error), path=path) from None


def _document(text: str, path: str) -> dict[Any, Any]:
    try:
        document = yaml.load(text, Loader=getattr(yaml, "CSafeLoader", yaml.SafeLoader))  # noqa: S506
    except (yaml.YAMLError, RecursionError, ValueError) as error:
        raise InputError(f"not YAML: {error}", path=path) from None
    if not isinstance(document, dict):
        raise InputError("holds no rules", path=path)
    return document
