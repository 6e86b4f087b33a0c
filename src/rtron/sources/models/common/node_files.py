"""A YAML file that a node reads itself, named by a parameter or an argument."""

from pathlib import Path

from rtron.errors import InputError
from rtron.sources.models.common.values import Hole, Value, has_hole, hole
from rtron.sources.models.common.yaml_model import compose, plain


def yaml_file(path: Value) -> Value:
    """Return what a YAML file holds; a hole if it cannot be read."""
    if isinstance(path, Hole) or has_hole(path):
        return hole(f"yaml_file {path}")
    place = Path(str(path))
    if not place.is_file():
        return hole(f"yaml_file {place.name}")
    try:
        return plain(compose(place), place)
    except InputError:
        return hole(f"yaml_file {place.name}")
