"""A launch file of ROS 2 that is being read, and what was found in it."""

from dataclasses import dataclass, field

from rtron.sources.launch.ros2.xml_yaml.element import Element
from rtron.vocabulary import Evidence, LaunchFile, LaunchInclude, LaunchNode


@dataclass(slots=True)
class FileInclusion:
    """One inclusion of a file; `depth` files include it."""

    path: str
    depth: int
    nodes: list[LaunchNode] = field(default_factory=list)
    includes: list[tuple[Element, str, "FileInclusion"]] = field(default_factory=list)

    def launch_file(self) -> LaunchFile:
        """Return the file with all that was found."""
        return LaunchFile(
            path=self.path,
            nodes=tuple(self.nodes),
            includes=tuple(
                LaunchInclude(
                    element_index=element.position,
                    evaluated_name=spelled_path,
                    file=file.launch_file(),
                )
                for element, spelled_path, file in self.includes
            ),
        )


def element_location(element: Element, file: FileInclusion) -> Evidence:
    """Return where an element stands."""
    return Evidence(file=element.file or file.path, line=element.line)
