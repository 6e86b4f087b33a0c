"""What substitutions look up outside of the launch: packages and programs (ament)."""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from rtron.folders import is_there
from rtron.sources.launch.common.commands import Cat
from rtron.sources.launch.common.errors import UnresolvableError
from rtron.sources.launch.ros2.bundled_files import is_known
from rtron.sources.launch.ros2.substitutions.command_output import Commands
from rtron.sources.launch.ros2.substitutions.functions import Function, closed, given
from rtron.sources.launch.ros2.substitutions.template import hole, shown


@dataclass(frozen=True, slots=True)
class Lookups:
    """Finds packages in a workspace, then below AMENT_PREFIX_PATH.

    Where the source is read (`symbolic`), what a build installs elsewhere is not known.
    """

    environ: Mapping[str, str]
    packages: Mapping[str, Path]
    symbolic: bool
    commands: Commands

    def functions(self) -> Mapping[str, Function]:
        """Return the substitutions by their names."""
        return {
            "find-pkg-share": self._share,
            "find-pkg-prefix": self._prefix,
            "exec-in-pkg": self._executable,
            "find-exec": lambda words: given(words, 1, 1)[0],
            "command": self._command,
            "file-content": self._content,
        }

    def _share(self, words: list[str]) -> str:
        name = closed("".join(words[:1]))
        if name in self.packages:
            return str(self.packages[name])
        for prefix in filter(None, self.environ.get("AMENT_PREFIX_PATH", "").split(":")):
            share = Path(prefix) / "share" / name
            if is_there(share) and share.is_dir():
                return str(share)
        if self.symbolic and is_known(name):
            return hole(f"find-pkg-share {name}")
        raise UnresolvableError(f"package '{name}' is not here")

    def _prefix(self, words: list[str]) -> str:
        if self.symbolic and "".join(words[:1]) in self.packages:
            raise UnresolvableError(f"where '{words[0]}' is installed is not known before a build")
        return str(Path(self._share(words)).parents[1])

    def _executable(self, words: list[str]) -> str:
        executable, package = given(words, 2, 2)
        return f"{self._prefix([package])}/lib/{package}/{executable}"

    def _content(self, words: list[str]) -> str:
        path = closed(given(words, 1, 1)[0])
        if not self.symbolic:
            raise UnresolvableError(f"$(file-content {path[:80]}) is not read")
        return self.commands.output(Cat(file=path))

    def _command(self, words: list[str]) -> str:
        command = given(words, 1, 2)[0]
        if not self.symbolic:
            raise UnresolvableError(f"$(command {shown(command)[:80]}) is not run")
        return self.commands.printed(command)
