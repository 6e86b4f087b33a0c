"""Copies of packages in which some launch files are guarded (ROS wiki: ROS_PACKAGE_PATH).

Both `$(find …)` and rospkg take the first package of a name on ROS_PACKAGE_PATH and follow links.
The copies lie to each other as the originals do, for scripts that look beside themselves.
"""

import os.path
from collections.abc import Collection, Mapping
from dataclasses import dataclass
from pathlib import Path

from rtron.planning.instrument.ros1.launch_prefix_script import OVERLAY_FOLDER, starter_script
from rtron.planning.instrument.ros1.mirror import mirror_links
from rtron.planning.instrument.ros1.package_files import PackageFile
from rtron.vocabulary import LaunchNode


@dataclass(frozen=True, slots=True, kw_only=True)
class Overlay:
    """The overlay's content: `launches` are guarded, `programs` and `modules` are copied.

    `unchanged_launches` are other files that must be found beside those; `folder` is the guarded launch's.
    """

    folder: Path
    launches: Collection[PackageFile]
    programs: Mapping[PackageFile, LaunchNode]
    modules: Collection[PackageFile]
    unchanged_launches: Collection[PackageFile]

    @property
    def root(self) -> Path:
        """The folder that is mirrored: the nearest one that holds all the packages."""
        package_files = (*self._changed, *self.unchanged_launches)
        return Path(
            os.path.commonpath([package_file.package.parent for package_file in package_files])
        )

    def overlay_path(self, package_file: PackageFile) -> Path:
        """Return where a file of a package lies in the overlay."""
        return self.folder / OVERLAY_FOLDER / self._relative_path(package_file.path)

    def copies(self) -> dict[Path, Path]:
        """Return the scripts that are copied, and from where."""
        return {
            self.overlay_path(package_file): package_file.path
            for package_file in (*self.programs, *self.modules)
        }

    def links(self, left_out: Collection[Path]) -> dict[Path, Path]:
        """Return the links, and where they lead; raise InputError as `mirror_links` does."""
        changed = [package_file.path for package_file in self._changed]
        links = mirror_links(self.root, changed, left_out)
        return {self.folder / OVERLAY_FOLDER / self._relative_path(link): link for link in links}

    def packages(self) -> list[Path]:
        """Return the packages that are copied."""
        return list(dict.fromkeys(package_file.package for package_file in self._changed))

    def script(self) -> str:
        """Return the launch-prefix of the nodes that start launch files."""
        packages = [self._relative_path(package) for package in self.packages()]
        programs = {
            package_file.path: (
                f"{node.package}/{node.type}",
                self._relative_path(package_file.path),
            )
            for package_file, node in self.programs.items()
        }
        return starter_script(packages, programs)

    @property
    def _changed(self) -> tuple[PackageFile, ...]:
        return (*self.launches, *self.programs, *self.modules)

    def _relative_path(self, path: Path) -> Path:
        return path.relative_to(self.root)
