"""`load_yaml`: a YAML file as dicts and lists, with xacro's units (ROS wiki: xacro, YAML)."""

import math
from collections.abc import Callable, Mapping
from pathlib import Path

import yaml

from rtron.sources.bounded_file import read_bounded
from rtron.sources.launch.common.expression_library import Value

MAX_BYTES = 256 * 1024
MAX_MERGED = 20_000

UNITS: Mapping[str, float] = {
    "!radians": 1.0,
    "!degrees": math.pi / 180.0,
    "!meters": 1.0,
    "!millimeters": 0.001,
    "!foot": 0.3048,
    "!inches": 0.0254,
}


def load_yaml(path: Path, number: Callable[[str], Value]) -> Value:
    """Return what a YAML file says; `number` evaluates what stands behind a unit.

    Raise InputError if it cannot be read, ValueError if it is not YAML of plain values.
    """
    loader = _Loader(read_bounded(path, MAX_BYTES), number)
    try:
        return loader.get_single_data()
    except (yaml.YAMLError, RecursionError) as error:
        raise ValueError(f"{path}: {str(error) or 'nested too deep'}") from None
    finally:
        loader.dispose()


class _Loader(yaml.SafeLoader):
    """Knows the units, and merges (`<<`) only so much: merges of merges grow without end."""

    def __init__(self, data: bytes, number: Callable[[str], Value]) -> None:
        super().__init__(data)
        self._number = number
        self._merged = 0

    def flatten_mapping(self, node: yaml.MappingNode) -> None:
        for key, value in node.value:
            merges = key.tag == "tag:yaml.org,2002:merge"
            parts = value.value if isinstance(value, yaml.SequenceNode) else [value]
            self._merged += sum(len(part.value) for part in parts) if merges else 0
            if self._merged > MAX_MERGED:
                raise yaml.YAMLError("merges too much")
        super().flatten_mapping(node)

    def construct_quantity(self, node: yaml.ScalarNode) -> float:
        return float(self._number(str(node.value))) * UNITS[node.tag]


for _unit in UNITS:
    _Loader.add_constructor(_unit, _Loader.construct_quantity)
