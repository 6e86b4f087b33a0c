"""Copies of packages in which some launch files are guarded (ROS wiki: ROS_PACKAGE_PATH).

Both `$(find …)` and rospkg take the first package of a name on ROS_PACKAGE_PATH and follow links.
The copies lie to each other as the originals do, for scripts that look beside themselves.
"""

import os.path
from collections.abc import Collection, Mapping
from dataclasses import dataclass
from pathlib import Path

from rtron.planning.instrument.ros1.launch_prefix_script import OVERLAY, starter_script
from rtron.planning.instrument.ros1.mirror import mirror_links
from rtron.planning.instrument.ros1.package_files import PackagePlace
from rtron.vocabulary import LaunchNode


@dataclass(frozen=True, slots=True, kw_only=True)
class Overlay:
    """The overlay's content: `launches` are guarded, `programs` and `modules` are copied.

    `seen` are other files that must be found beside those; `folder` is the guarded launch's.
    """

    folder: Path
    launches: Collection[PackagePlace]
    programs: Mapping[PackagePlace, LaunchNode]
    modules: Collection[PackagePlace]
    seen: Collection[PackagePlace]

    @property
    def root(self) -> Path:
        """The folder that is mirrored: the nearest one that holds all the packages."""
        places = (*self._changed, *self.seen)
        return Path(os.path.commonpath([place.package.parent for place in places]))

    def at(self, place: PackagePlace) -> Path:
        """Return where a file of a package lies in the overlay."""
        return self.folder / OVERLAY / self._below(place.path)

    def copies(self) -> dict[Path, Path]:
        """Return the scripts that are copied, and from where."""
        return {self.at(place): place.path for place in (*self.programs, *self.modules)}

    def links(self, left_out: Collection[Path]) -> dict[Path, Path]:
        """Return the links, and where they lead; raise InputError as `mirror_links` does."""
        changed = [place.path for place in self._changed]
        links = mirror_links(self.root, changed, left_out)
        return {self.folder / OVERLAY / self._below(link): link for link in links}

    def packages(self) -> list[Path]:
        """Return the packages that are copied."""
        return list(dict.fromkeys(place.package for place in self._changed))

    def script(self) -> str:
        """Return the launch-prefix of the nodes that start launch files."""
        packages = [self._below(package) for package in self.packages()]
        programs = {
            place.path: (f"{node.package}/{node.type}", self._below(place.path))
            for place, node in self.programs.items()
        }
        return starter_script(packages, programs)

    @property
    def _changed(self) -> tuple[PackagePlace, ...]:
        return (*self.launches, *self.programs, *self.modules)

    def _below(self, path: Path) -> Path:
        return path.relative_to(self.root)
