"""The YAML files that lie beside the code."""

from functools import cache
from importlib.resources import files
from typing import Any

import yaml

_LOADER: Any = getattr(yaml, "CSafeLoader", yaml.SafeLoader)


@cache
def load_package_yaml(package: str, name: str) -> Any:  # noqa: ANN401 - any YAML value
    """Return what a YAML file of a package of ours holds; raise FileNotFoundError if none is."""
    text = (files(package) / name).read_text(encoding="utf-8")
    return yaml.load(text, Loader=_LOADER)  # noqa: S506 - a safe loader
