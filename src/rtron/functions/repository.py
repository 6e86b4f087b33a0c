"""A repository as the classifier sees it: names, manifests' descriptions and README."""

from dataclasses import dataclass, field
from pathlib import Path


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
