"""Well-known robot descriptions that are often not in a workspace: the Gazebo plugins they bring.

docs/models.md explains the form with an example.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from typing import Any

from pydantic import BaseModel, ConfigDict, Field

from rtron.sources.models.values import Value
from rtron.vocabulary import Evidence


@dataclass(frozen=True, slots=True, kw_only=True)
class PluginElement:
    """A `<plugin>` of SDF or URDF: its file, its elements by name, and the sensor it stands in.

    `values` maps an element's name to its text, or to such a mapping where elements are nested;
    an element that stands several times is a list of these. `robot_namespace` is what the spawner
    adds where the element has none (gazebo_ros: spawn_model's namespace); empty for a world's own.
    """

    filename: str
    name: str = ""
    values: Mapping[str, Any] = field(default_factory=dict)
    sensor_name: str = ""
    sensor_type: str = ""
    cameras: tuple[str, ...] = ()
    link_name: str = ""
    model_name: str = ""
    robot_namespace: str = "/"

    def variables(self) -> dict[str, Value]:
        """Return the variables that a plugin's model sees."""
        spawned = {"robotNamespace": self.robot_namespace} if self.robot_namespace else {}
        return {
            "values": {**spawned, **self.values},
            "model_name": self.model_name,
            "plugin_name": self.name,
            "sensor_name": self.sensor_name,
            "sensor_type": self.sensor_type,
            "cameras": list(self.cameras),
            "link_name": self.link_name,
        }


@dataclass(frozen=True, slots=True, kw_only=True)
class Description:
    """What one description file brings: Gazebo plugins, and where that was read."""

    plugins: tuple[PluginElement, ...] = ()
    evidence: tuple[Evidence, ...] = ()


class _Plugin(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True)

    filename: str
    name: str = ""
    values: dict[str, Any] = {}
    sensor_name: str = ""
    sensor_type: str = ""
    link_name: str = ""
    line: int = 0


class _File(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True)

    path: str
    plugins: tuple[_Plugin, ...] = Field(default=())


class DescriptionForm(BaseModel):
    """A YAML file on one description package: its source and its files."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    package: str
    source: str
    files: tuple[_File, ...]

    def descriptions(self) -> Iterator[tuple[tuple[str, str], Description]]:
        """Yield each file's (package, path) with what it brings."""
        for file in self.files:
            plugins = tuple(PluginElement(**p.model_dump(exclude={"line"})) for p in file.plugins)
            place = f"{self.source}/{file.path}"
            evidence = tuple(Evidence(file=place, line=p.line) for p in file.plugins)
            yield (self.package, file.path), Description(plugins=plugins, evidence=evidence)
