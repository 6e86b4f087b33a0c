"""A launch file of ROS 2 that is being read, and what was found in it."""

from dataclasses import dataclass, field

from rtron.sources.launch.ros2.xml_yaml.element import Element
from rtron.vocabulary import Evidence, LaunchFile, LaunchInclude, LaunchNode


@dataclass(slots=True)
class Place:
    """One inclusion of a file; `depth` files include it."""

    path: str
    depth: int
    nodes: list[LaunchNode] = field(default_factory=list)
    includes: list[tuple[Element, str, "Place"]] = field(default_factory=list)

    def file(self) -> LaunchFile:
        """Return the file with all that was found."""
        return LaunchFile(
            path=self.path,
            nodes=tuple(self.nodes),
            includes=tuple(
                LaunchInclude(element=element.place, spelled=spelled, file=place.file())
                for element, spelled, place in self.includes
            ),
        )


def evidence_of(element: Element, place: Place) -> Evidence:
    """Return where an element stands."""
    return Evidence(file=element.file or place.path, line=element.line)
