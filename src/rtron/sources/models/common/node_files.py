"""A YAML file that a node reads itself, named by a parameter or an argument."""

from pathlib import Path

from rtron.errors import InputError
from rtron.sources.models.common.values import Placeholder, Value, has_placeholder, placeholder
from rtron.sources.models.common.yaml_model import compose_yaml, construct_value


def read_yaml_file(path: Value) -> Value:
    """Return what a YAML file holds; a hole if it cannot be read."""
    if isinstance(path, Placeholder) or has_placeholder(path):
        return placeholder(f"yaml_file {path}")
    file = Path(str(path))
    if not file.is_file():
        return placeholder(f"yaml_file {file.name}")
    try:
        return construct_value(compose_yaml(file), file)
    except InputError:
        return placeholder(f"yaml_file {file.name}")
