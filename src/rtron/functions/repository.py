"""A repository as the classifier sees it: names, manifests' descriptions and README."""

from dataclasses import dataclass, field
from functools import cache
from importlib.resources import files
from pathlib import Path
from typing import Any

import yaml


@dataclass(frozen=True, slots=True, kw_only=True)
class SourcePackage:
    """A package: its name, its manifest's description and the packages its manifest depends on.

    `code` are facts of its other files, each a kind and a name (`publishes sensor_msgs/Joy`).
    `folder` is where it lies, None for one that is only told of.
    """

    name: str
    description: str = ""
    depends: tuple[str, ...] = ()
    code: frozenset[str] = frozenset()
    folder: Path | None = field(default=None, compare=False)


@dataclass(frozen=True, slots=True, kw_only=True)
class SourceRepository:
    """A repository: what can be read of it without running or building anything."""

    name: str
    packages: tuple[SourcePackage, ...] = ()
    readme: str = ""
    url: str = ""


_LOADER: Any = getattr(yaml, "CSafeLoader", yaml.SafeLoader)


@cache
def load_package_yaml(package: str, name: str) -> Any:  # noqa: ANN401 - any YAML value
    """Return what a YAML file of a package of ours holds; raise FileNotFoundError if none is."""
    text = (files(package) / name).read_text(encoding="utf-8")
    return yaml.load(text, Loader=_LOADER)  # noqa: S506 - a safe loader
