"""Where a launch evaluates an element: the context that counts there, and the file around it."""

from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from pathlib import Path

from rtron.sources.launch.ros2.launch_context import LaunchContext
from rtron.sources.launch.ros2.xml_yaml import Element
from rtron.sources.workspace import Workspace
from rtron.vocabulary import Evidence, LaunchFile, LaunchInclude, LaunchNode


@dataclass(slots=True)
class FileInclusion:
    """One inclusion of a file, with what was found in it; `depth` files include it."""

    path: str
    depth: int
    nodes: list[LaunchNode] = field(default_factory=list)
    includes: list[tuple[Element, str, "FileInclusion"]] = field(default_factory=list)

    def paths(self) -> Iterator[str]:
        """Yield the paths of the file and of all that it includes."""
        yield self.path
        for _, _, file in self.includes:
            yield from file.paths()

    def launch_file(self) -> LaunchFile:
        """Return the file with all that was found."""
        return LaunchFile(
            path=self.path,
            nodes=tuple(self.nodes),
            includes=tuple(
                LaunchInclude(
                    element_index=element.position,
                    evaluated_name=evaluated_name,
                    file=file.launch_file(),
                )
                for element, evaluated_name, file in self.includes
            ),
        )


@dataclass(frozen=True, slots=True)
class ElementSite:
    """An element, the context that it is evaluated in, and the file that it stands in."""

    element: Element
    context: LaunchContext
    file: FileInclusion

    @property
    def tag(self) -> str:
        """The element's tag."""
        return self.element.tag

    @property
    def location(self) -> Evidence:
        """The file and the line of the element."""
        return Evidence(file=self.element.file or self.file.path, line=self.element.line)

    def at(self, element: Element) -> "ElementSite":
        """Return another element in the same context and file."""
        return replace(self, element=element)

    def children(self, *tags: str) -> Iterator["ElementSite"]:
        """Yield the children of one tag after the other."""
        return (self.at(child) for tag in tags for child in self.element.children_named(tag))

    def has(self, key: str) -> bool:
        """Tell whether the element has an attribute."""
        return key in self.element.attributes

    def plain_text(self, key: str) -> str:
        """Return an attribute as it is written; empty where it is not plain text."""
        return self.element.plain_text(key)


@dataclass(frozen=True, slots=True)
class SourceLocator:
    """Finds the source of a file that is asked for in a package's share folder."""

    workspace: Workspace

    def __call__(self, path: str) -> str:
        """Return a file's source: itself, or the one file of its package with its name."""
        found = self.workspace.installed_source(Path(path))
        return path if found == Path(path) else str(found)
