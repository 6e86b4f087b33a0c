"""A YAML scalar's value, as far as a parameter can hold it (ROS wiki: Parameter Server)."""

import math
from collections.abc import Callable, Mapping
from typing import Any

import yaml

from rtron.sources.launch.common.errors import UnresolvableError
from rtron.sources.launch.common.expression import evaluate
from rtron.vocabulary import ParameterValue, UnknownValue

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
