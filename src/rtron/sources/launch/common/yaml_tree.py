"""YAML as rosparam reads it: values with the lines of their keys (ROS wiki: rosparam, YAML format).

No tag makes an object: what is not plain data becomes an UnknownValue and a fault. Size, depth
and the values that aliases multiply are bounded.
"""

import math
import re
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from typing import Any, TypeAlias

import yaml

from rtron.errors import InputError
from rtron.sources.launch.common.errors import UnresolvableError
from rtron.sources.launch.common.expression import evaluate
from rtron.vocabulary import ParameterValue, UnknownValue
from rtron.yaml_safety import SAFE_LOADER, YamlRules, check_yaml, yaml_errors

MAX_DEPTH = 100
MAX_VALUES = 100_000
_RULES = YamlRules(max_depth=MAX_DEPTH, max_values=2 * MAX_VALUES, allows_aliases=True)

_MAP = "tag:yaml.org,2002:map"
_SEQUENCE = "tag:yaml.org,2002:seq"
_MERGE = "tag:yaml.org,2002:merge"
_STRINGS = frozenset({"tag:yaml.org,2002:str", "tag:yaml.org,2002:value"})

_Loader: Any = type("_Loader", (SAFE_LOADER,), {})
_Loader.add_implicit_resolver("!degrees", re.compile(r"^deg\([^\)]*\)$"), "d")
_Loader.add_implicit_resolver("!radians", re.compile(r"^rad\([^\)]*\)$"), "r")


@dataclass(frozen=True, slots=True, kw_only=True)
class YamlLeaf:
    """A value that is no mapping, and the line of its key."""

    value: ParameterValue
    line: int


class YamlMapping(dict[str, "YamlTree"]):
    """A mapping; of a key that stands twice the last entry counts.

    rcl, unlike libraries for YAML, also takes the `earlier` ones.
    """

    def __init__(self) -> None:
        self.earlier: list[tuple[str, YamlTree]] = []

    def add(self, key: str, tree: "YamlTree") -> None:
        """Take the next entry."""
        if key in self:
            self.earlier.append((key, self[key]))
        self[key] = tree


YamlTree: TypeAlias = "YamlLeaf | dict[str, YamlTree]"
YamlDocument: TypeAlias = "YamlTree | None"


@dataclass(frozen=True, slots=True, kw_only=True)
class YamlFile:
    """The documents of a YAML text, None for an empty one, and what in them has no value."""

    path: str
    documents: tuple[YamlDocument, ...]
    errors: tuple[InputError, ...] = ()


def parse_yaml(text: str, path: str, first_line: int = 1) -> YamlFile:
    """Parse a YAML text that begins on `first_line` of a file.

    Raise InputError, with the line, if it is no YAML or larger than the bounds.
    """
    builder = _TreeBuilder(path=path, first_line=first_line)
    with yaml_errors(path, first_line):
        check_yaml(text, path, _RULES, first_line=first_line, loader=_Loader)
        roots = list(yaml.compose_all(text, Loader=_Loader))
    documents = tuple(None if _is_empty(root) else builder.tree(root) for root in roots)
    return YamlFile(path=path, documents=documents, errors=tuple(builder.errors))


def all_entries(mapping: dict[str, YamlTree]) -> Iterator[tuple[str, YamlTree]]:
    """Yield the entries of a mapping, before them those whose keys stand again further down."""
    if isinstance(mapping, YamlMapping):
        yield from mapping.earlier
    yield from mapping.items()


def plain_value(tree: YamlTree) -> ParameterValue:
    """Return a tree's value without its lines."""
    if isinstance(tree, YamlLeaf):
        return tree.value
    return {key: plain_value(inner) for key, inner in tree.items()}


def _is_empty(root: yaml.Node) -> bool:
    return root.tag == "tag:yaml.org,2002:null"


@dataclass(slots=True, kw_only=True)
class _TreeBuilder:
    """Makes values of YAML nodes; every node costs, however often an alias brings it again."""

    path: str
    first_line: int
    errors: list[InputError] = field(default_factory=list)
    _values: int = 0
    _depth: int = 0

    def tree(self, node: yaml.Node) -> YamlTree:
        if isinstance(node, yaml.MappingNode) and node.tag == _MAP:
            return self._mapping(node)
        return YamlLeaf(value=self._value(node), line=self._line(node))

    def _mapping(self, node: yaml.MappingNode) -> dict[str, YamlTree]:
        self._enter_level(node)
        mapping = YamlMapping()
        for key, inner in self._pairs(node):
            name = self._key(key)
            tree = self.tree(inner)
            if name is not None:
                mapping.add(name, self._with_key_line(tree, key))
        self._depth -= 1
        return mapping

    def _with_key_line(self, tree: YamlTree, key: yaml.Node) -> YamlTree:
        return tree if isinstance(tree, dict) else replace(tree, line=self._line(key))

    def _value(self, node: yaml.Node) -> ParameterValue:
        if isinstance(node, yaml.MappingNode) and node.tag == _MAP:
            return plain_value(self._mapping(node))
        if isinstance(node, yaml.SequenceNode) and node.tag == _SEQUENCE:
            return self._list(node)
        self._count_value(node)
        try:
            return scalar_value(node)
        except ValueError as error:
            return self._unknown_value(node, str(error))

    def _list(self, node: yaml.SequenceNode) -> list[ParameterValue]:
        self._enter_level(node)
        values = [self._value(inner) for inner in node.value]
        self._depth -= 1
        return values

    def _pairs(self, node: yaml.MappingNode) -> Iterator[tuple[yaml.Node, yaml.Node]]:
        """Yield a mapping's entries, those that `<<` merges into it first."""
        self._enter_level(node)
        for key, value in node.value:
            if key.tag == _MERGE:
                for merged in self._merged(value):
                    yield from self._pairs(merged)
        yield from (pair for pair in node.value if pair[0].tag != _MERGE)
        self._depth -= 1

    def _merged(self, node: yaml.Node) -> list[yaml.MappingNode]:
        nodes = reversed(node.value) if isinstance(node, yaml.SequenceNode) else [node]
        mappings = [inner for inner in nodes if isinstance(inner, yaml.MappingNode)]
        if not mappings:
            self._unknown_value(node, "only a mapping can be merged")
        return mappings

    def _key(self, node: yaml.Node) -> str | None:
        if isinstance(node, yaml.ScalarNode) and node.tag in _STRINGS:
            return str(node.value)
        self._unknown_value(node, "a parameter's name must be a string")
        return None

    def _unknown_value(self, node: yaml.Node, why: str) -> UnknownValue:
        self.errors.append(InputError(why, path=self.path, line=self._line(node)))
        return UnknownValue(why)

    def _enter_level(self, node: yaml.Node) -> None:
        self._count_value(node)
        self._depth += 1
        if self._depth > 2 * MAX_DEPTH:
            raise InputError("is nested too deep", path=self.path, line=self._line(node))

    def _count_value(self, node: yaml.Node) -> None:
        self._values += 1
        if self._values > MAX_VALUES:
            why = f"has more than {MAX_VALUES} values, counting what aliases repeat"
            raise InputError(why, path=self.path, line=self._line(node))

    def _line(self, node: yaml.Node) -> int:
        return self.first_line + int(node.start_mark.line)


_YAML = "tag:yaml.org,2002:"
_INT_LIMIT = 2**31
_SAFE: Any = yaml.constructor.SafeConstructor()


def scalar_value(node: yaml.Node) -> ParameterValue:
    """Return a node's value; raise ValueError if it has none that a parameter can have."""
    construct = _CONSTRUCTORS.get(node.tag)
    if node.tag == f"{_YAML}null":
        raise ValueError("a parameter cannot be null")
    if construct is None or not isinstance(node, yaml.ScalarNode):
        raise ValueError(f"tag {node.tag.replace(_YAML, '!!')} is not of a parameter")
    try:
        return check_int_range(construct(node))
    except (ArithmeticError, LookupError, UnresolvableError) as error:
        raise ValueError(f"{str(node.value)[:80]}: {error}") from None


def check_int_range(value: ParameterValue) -> ParameterValue:
    """Return a value; raise ValueError for an int that the parameter server cannot hold."""
    if isinstance(value, int) and not -_INT_LIMIT <= value < _INT_LIMIT:
        raise ValueError("an int of the parameter server has 32 bits")
    return value


def _radians(node: yaml.ScalarNode) -> float:
    text = str(node.value).strip()
    return float(evaluate(text[4:-1] if text.startswith("rad(") else text, {}, _reject_name))


def _degrees(node: yaml.ScalarNode) -> float:
    text = str(node.value)
    number = text.strip()[4:-1] if text.startswith("deg(") else text
    return float(number) * math.pi / 180.0


def _reject_name(name: str) -> float:
    raise ValueError(f"`{name}` is no number")


_CONSTRUCTORS: Mapping[str, Callable[[yaml.ScalarNode], ParameterValue]] = {
    f"{_YAML}bool": _SAFE.construct_yaml_bool,
    f"{_YAML}int": _SAFE.construct_yaml_int,
    f"{_YAML}float": _SAFE.construct_yaml_float,
    f"{_YAML}str": _SAFE.construct_yaml_str,
    f"{_YAML}value": _SAFE.construct_yaml_str,
    f"{_YAML}binary": lambda node: UnknownValue("binary data"),
    "!radians": _radians,
    "!degrees": _degrees,
}
