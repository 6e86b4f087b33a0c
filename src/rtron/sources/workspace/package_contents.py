"""What a package builds and installs."""

from dataclasses import dataclass
from pathlib import Path

from rtron.vocabulary import Evidence, Unresolved, Word


class TargetKind(Word):
    """What a target becomes."""

    EXECUTABLE = "executable"
    LIBRARY = "library"


@dataclass(frozen=True, slots=True, kw_only=True)
class Target:
    """A target of CMake.

    `sources` are the files that exist, without headers; `links` names libraries and, for
    `${x_LIBRARIES}`, packages; `definitions` are macros, `NAME` or `NAME=value`; `output` is the
    file's name without `lib` and `.so`.
    """

    name: str
    kind: TargetKind
    sources: tuple[Path, ...] = ()
    links: tuple[str, ...] = ()
    definitions: tuple[str, ...] = ()
    output: str = ""
    evidence: Evidence


@dataclass(frozen=True, slots=True, kw_only=True)
class Component:
    """A class of ROS 2 that a container can load: the library target that holds it.

    `executable` is the program that rclcpp_components makes of it, empty where none is asked for.
    """

    cls: str
    library: str
    executable: str = ""
    evidence: Evidence


@dataclass(frozen=True, slots=True, kw_only=True)
class PackageContents:
    """What a package's CMake files build and install.

    `found` names what find_package() asks for, catkin's components among it; `installed` are
    scripts with the name under which they are installed; `exports` are descriptions of plugins
    with the package of their base class (ROS 2).
    """

    name: str
    path: Path
    targets: tuple[Target, ...] = ()
    include_dirs: tuple[Path, ...] = ()
    found: tuple[str, ...] = ()
    installed: tuple[tuple[str, Path], ...] = ()
    components: tuple[Component, ...] = ()
    exports: tuple[tuple[str, Path], ...] = ()
    unresolved: tuple[Unresolved, ...] = ()

    def target(self, name: str, kind: TargetKind) -> Target | None:
        """Return the target of a kind with this name, or whose file has it."""
        ours = [target for target in self.targets if target.kind is kind]
        named = (target for target in ours if name in {target.name, target.output})
        return next(named, None)
