"""Loading the rules: one file per function type, and the lists of words that they share."""

from __future__ import annotations

from functools import cache
from importlib.resources import files
from typing import TYPE_CHECKING, Annotated, Any

import yaml
from pydantic import BaseModel, ConfigDict, Field, ValidationError

from rtron.errors import InputError
from rtron.functions.classifier.result import InformationSource
from rtron.functions.patterns.parser import parse_pattern
from rtron.functions.patterns.syntax_tree import PatternIndex
from rtron.functions.rules.code_rules import FunctionRule
from rtron.vocabulary import FunctionType

if TYPE_CHECKING:
    from collections.abc import Mapping

    from rtron.functions.patterns.syntax_tree import PatternNode
    from rtron.vocabulary import FunctionType


_TEXTS = (InformationSource.NAME, InformationSource.MANIFEST, InformationSource.README)
RuleText = Annotated[str, Field(min_length=1, max_length=2000)]
RuleTexts = Annotated[tuple[RuleText, ...], Field(max_length=200)]


class RuleSchema(BaseModel):
    """A rule as it is written."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    id: Annotated[str, Field(pattern=r"^[a-z][a-z0-9-]*$")]
    weight: Annotated[float, Field(ge=1, le=9)]
    patterns: Annotated[RuleTexts, Field(min_length=1)]
    pieces: Annotated[tuple[InformationSource, ...], Field(min_length=1)] = _TEXTS
    vetoes: RuleTexts = ()
    matches: Annotated[RuleTexts, Field(min_length=1)]
    excludes: Annotated[RuleTexts, Field(alias="not", min_length=1)]


class RuleFileSchema(BaseModel):
    """A file of rules."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    type: FunctionType
    rules: Annotated[tuple[RuleSchema, ...], Field(min_length=1)]


_DATA = files("rtron.functions.rules") / "data"
_WORD_LISTS = "words.yaml"


@cache
def load_rules() -> tuple[FunctionRule, ...]:
    """Return every rule that RTron brings."""
    lists = parse_word_lists((_DATA / _WORD_LISTS).read_text("utf-8"), _WORD_LISTS)
    names = sorted(file.name for file in _DATA.iterdir() if file.name.endswith(".yaml"))
    texts = ((name, (_DATA / name).read_text("utf-8")) for name in names if name != _WORD_LISTS)
    return tuple(rule for name, text in texts for rule in parse_rules(text, name, lists))


@cache
def load_rule_index() -> PatternIndex[FunctionRule]:
    """Return the patterns of every rule."""
    return PatternIndex((pattern, rule) for rule in load_rules() for pattern in rule.patterns)


def parse_word_lists(text: str, path: str) -> Mapping[str, PatternNode]:
    """Return the lists of words in a YAML text; raise InputError where one is wrong."""
    lists: dict[str, PatternNode] = {}
    for name, written in _document(text, path).items():
        lists[str(name)] = _pattern(str(written), lists, path)
    return lists


def parse_rules(text: str, path: str, lists: Mapping[str, PatternNode]) -> tuple[FunctionRule, ...]:
    """Return the rules in a YAML text; raise InputError where one is wrong."""
    try:
        file = RuleFileSchema.model_validate(_document(text, path))
    except ValidationError as error:
        first = error.errors()[0]
        location = ".".join(map(str, first["loc"]))
        raise InputError(f"{location}: {first['msg']}", path=path) from None
    return tuple(_rule(rule, file.type, lists, path) for rule in file.rules)


def _rule(
    rule: RuleSchema, type: FunctionType, lists: Mapping[str, PatternNode], path: str
) -> FunctionRule:
    return FunctionRule(
        id=rule.id,
        type=type,
        weight=rule.weight,
        patterns=tuple(_pattern(text, lists, path) for text in rule.patterns),
        sources=frozenset(rule.pieces),
        vetoes=tuple(_pattern(text, lists, path) for text in rule.vetoes),
        matches=rule.matches,
        excludes=rule.excludes,
    )


def _pattern(text: str, lists: Mapping[str, PatternNode], path: str) -> PatternNode:
    try:
        return parse_pattern(text, lists)
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
