"""What a package builds and installs."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path, PurePath

from rtron.vocabulary import Evidence, StringEnum, UnresolvedItem


class TargetKind(StringEnum):
    """What a target becomes."""

    EXECUTABLE = "executable"
    LIBRARY = "library"


@dataclass(frozen=True, slots=True, kw_only=True)
class BuildTarget:
    """A target of CMake.

    `sources` are the files that exist, without headers; `links` names libraries and, for
    `${x_LIBRARIES}`, packages; `definitions` are macros, `NAME` or `NAME=value`; `output_name` is
    the file's name without `lib` and `.so`.
    """

    name: str
    kind: TargetKind
    sources: tuple[Path, ...] = ()
    links: tuple[str, ...] = ()
    definitions: tuple[str, ...] = ()
    output_name: str = ""


@dataclass(frozen=True, slots=True, kw_only=True)
class ComponentClass:
    """A class of ROS 2 that a container can load: the library target that holds it.

    `executable` is the program that rclcpp_components makes of it, empty where it makes none.
    """

    class_name: str
    library: str
    executable: str = ""


@dataclass(frozen=True, slots=True)
class LeftOut:
    """Why a build with the options' defaults leaves something out: `if(WITH_ARM)`, `return()`."""

    by: str
    evidence: Evidence


@dataclass(frozen=True, slots=True, kw_only=True)
class PackageContents:
    """What a package's CMake files build and install.

    `installed_scripts` are scripts with the name under which they are installed; `shared_files`
    are files and folders with the place in the share folder where they are installed;
    `plugin_descriptions` are descriptions of plugins with the package of their base class (ROS 2).
    `left_out` says of programs, libraries and classes by name why a build with the defaults leaves
    them out. With `is_open`, commands of its own make programs of which nothing is known.
    """

    name: str
    path: Path
    targets: tuple[BuildTarget, ...] = ()
    include_dirs: tuple[Path, ...] = ()
    installed_scripts: tuple[tuple[str, Path], ...] = ()
    shared_files: tuple[tuple[PurePath, Path], ...] = ()
    components: tuple[ComponentClass, ...] = ()
    plugin_descriptions: tuple[tuple[str, Path], ...] = ()
    left_out: Mapping[str, LeftOut] = field(default_factory=dict)
    is_open: bool = False
    unresolved: tuple[UnresolvedItem, ...] = ()

    def target(self, name: str, kind: TargetKind) -> BuildTarget | None:
        """Return the target of a kind with this name, or whose file has it."""
        ours = [target for target in self.targets if target.kind is kind]
        named = (target for target in ours if name in {target.name, target.output_name})
        return next(named, None)

    def shared_sources(self, path: Path) -> Iterator[Path]:
        """Yield what is installed at a path that is asked for below the package's folder."""
        place = path.relative_to(self.path)
        for installed, source in self.shared_files:
            if place.is_relative_to(installed):
                yield source / place.relative_to(installed)
