"""What substitutions look up outside of the launch: packages and programs (ament)."""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from rtron.folders import path_exists
from rtron.sources.launch.common.commands import CatCommand
from rtron.sources.launch.common.errors import UnresolvableError
from rtron.sources.launch.ros2.bundled_launches import has_bundled_launch_files
from rtron.sources.launch.ros2.substitutions.command_output import CommandOutput
from rtron.sources.launch.ros2.substitutions.functions import Function, require_arguments
from rtron.sources.launch.ros2.substitutions.template import (
    display_text,
    placeholder,
    require_known,
)


@dataclass(frozen=True, slots=True)
class PackageLookup:
    """Finds packages in a workspace, then below AMENT_PREFIX_PATH.

    Where the source is read (`symbolic`), what a build installs elsewhere is not known.
    """

    environ: Mapping[str, str]
    packages: Mapping[str, Path]
    symbolic: bool
    command_output: CommandOutput

    def functions(self) -> Mapping[str, Function]:
        """Return the substitutions by their names."""
        return {
            "find-pkg-share": self._share_folder,
            "find-pkg-prefix": self._install_prefix,
            "exec-in-pkg": self._executable_path,
            "find-exec": lambda words: require_arguments(words, 1, 1)[0],
            "command": self._command_line_output,
            "file-content": self._file_content,
        }

    def _share_folder(self, arguments: list[str]) -> str:
        name = require_known("".join(arguments[:1]))
        if name in self.packages:
            return str(self.packages[name])
        for prefix in filter(None, self.environ.get("AMENT_PREFIX_PATH", "").split(":")):
            share = Path(prefix) / "share" / name
            if path_exists(share) and share.is_dir():
                return str(share)
        if self.symbolic and has_bundled_launch_files(name):
            return placeholder(f"find-pkg-share {name}")
        raise UnresolvableError(f"package '{name}' is not here", name)

    def _install_prefix(self, arguments: list[str]) -> str:
        if self.symbolic and "".join(arguments[:1]) in self.packages:
            raise UnresolvableError(
                f"where '{arguments[0]}' is installed is not known before a build"
            )
        return str(Path(self._share_folder(arguments)).parents[1])

    def _executable_path(self, arguments: list[str]) -> str:
        executable, package = require_arguments(arguments, 2, 2)
        return f"{self._install_prefix([package])}/lib/{package}/{executable}"

    def _file_content(self, arguments: list[str]) -> str:
        path = require_known(require_arguments(arguments, 1, 1)[0])
        if not self.symbolic:
            raise UnresolvableError(f"$(file-content {path[:80]}) is not read")
        return self.command_output.output_of_command(CatCommand(file=path))

    def _command_line_output(self, arguments: list[str]) -> str:
        command = require_arguments(arguments, 1, 2)[0]
        if not self.symbolic:
            raise UnresolvableError(f"$(command {display_text(command)[:80]}) is not run")
        return self.command_output.output_of_line(command)
