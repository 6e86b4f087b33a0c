"""What commands print, none of them run: the robot of a xacro file, and files.

docs.ros.org: launch, `Command`; wiki.ros.org: xacro, its command line.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path

from rtron.errors import InputError
from rtron.folders import is_there
from rtron.sources.launch.common.commands import Cat, Xacro, recognise
from rtron.sources.launch.common.errors import UnresolvableError
from rtron.sources.launch.ros2.parameters.file import read_text
from rtron.sources.launch.ros2.substitutions.functions import closed
from rtron.sources.launch.ros2.substitutions.substitution import MAX_PRINTED
from rtron.sources.launch.ros2.substitutions.template import shown
from rtron.sources.xacro import evaluate_xacro
from rtron.vocabulary import Unresolved

MAX_DESCRIPTIONS = 32

_Key = tuple[str, tuple[tuple[str, str], ...]]


@dataclass(slots=True, kw_only=True)
class Commands:
    """Knows what xacro and cat would print; what else a command is, it is not known.

    `notes` gets what in a description has no value, `installed` finds the source of a file.
    """

    packages: Mapping[str, Path]
    environ: Mapping[str, str]
    installed: Callable[[str], str]
    notes: list[Unresolved]
    _described: dict[_Key, str | InputError] = field(default_factory=dict)

    def printed(self, command: str) -> str:
        """Return what a command line prints; raise UnresolvableError where that is not known."""
        run = recognise(command)
        if run is None:
            raise UnresolvableError(f"$(command {shown(command)[:80]}) is not run")
        closed(command)
        return self.output(run)

    def output(self, run: Cat | Xacro) -> str:
        """Return what a program prints; raise UnresolvableError where that is not known."""
        if not run.file.startswith("/"):
            raise UnresolvableError(f"{run.file[:80]}: the folder of the launch is not known")
        text = self._file(run) if isinstance(run, Cat) else self._description(run)
        if len(text) > MAX_PRINTED:
            raise UnresolvableError(f"{run.file}: more than {MAX_PRINTED} characters are printed")
        return text

    def _file(self, run: Cat) -> str:
        try:
            return read_text(self.installed(run.file))
        except InputError as error:
            raise UnresolvableError(str(error)) from None

    def _description(self, run: Xacro) -> str:
        key = self.installed(run.file), tuple(sorted(run.mappings.items()))
        if key not in self._described:
            if len(self._described) == MAX_DESCRIPTIONS:
                raise UnresolvableError(f"more than {MAX_DESCRIPTIONS} robots are described")
            self._described[key] = self._evaluated(Path(key[0]), run.mappings)
        found = self._described[key]
        if isinstance(found, InputError):
            raise UnresolvableError(str(found))
        return found

    def _evaluated(self, path: Path, mappings: Mapping[str, str]) -> str | InputError:
        try:
            result = evaluate_xacro(path, mappings, self._shares(), self.environ)
        except InputError as error:
            return error
        self.notes.extend(result.unresolved)
        return result.text

    def _shares(self) -> dict[str, Path]:
        """Return where the packages of the workspace and of AMENT_PREFIX_PATH lie."""
        found: dict[str, Path] = {}
        for prefix in filter(None, self.environ.get("AMENT_PREFIX_PATH", "").split(":")):
            share = Path(prefix) / "share"
            for folder in share.iterdir() if is_there(share) and share.is_dir() else ():
                found.setdefault(folder.name, folder)
        return {**found, **self.packages}
