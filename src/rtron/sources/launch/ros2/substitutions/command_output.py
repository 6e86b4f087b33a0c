"""What commands print, none of them run: the robot of a xacro file, and files.

docs.ros.org: launch, `Command`; wiki.ros.org: xacro, its command line.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path

from rtron.errors import InputError
from rtron.folders import path_exists
from rtron.sources.launch.common.commands import CatCommand, XacroCommand, recognise_command
from rtron.sources.launch.common.errors import UnresolvableError
from rtron.sources.launch.ros2.parameters.file import read_text_file
from rtron.sources.launch.ros2.substitutions.substitution import MAX_COMMAND_OUTPUT
from rtron.sources.launch.ros2.substitutions.template import display_text, require_known
from rtron.sources.xacro import evaluate_xacro, shorten_description
from rtron.vocabulary import Evidence, UnresolvedItem

MAX_DESCRIPTIONS = 32

_Key = tuple[str, tuple[tuple[str, str], ...]]


@dataclass(slots=True, kw_only=True)
class CommandOutput:
    """Knows what xacro and cat would print; what else a command is, it is not known.

    `unresolved` gets what in a description has no value, `locate_source` finds the source of a
    file.
    """

    packages: Mapping[str, Path]
    environ: Mapping[str, str]
    locate_source: Callable[[str], str]
    unresolved: list[UnresolvedItem]
    _descriptions: dict[_Key, str | InputError] = field(default_factory=dict)

    def output_of_line(self, command: str) -> str:
        """Return what a command line prints; raise UnresolvableError where that is not known."""
        program = recognise_command(command)
        if program is None:
            raise UnresolvableError(f"$(command {display_text(command)[:80]}) is not run")
        require_known(command)
        return self.output_of_command(program)

    def output_of_command(self, program: CatCommand | XacroCommand) -> str:
        """Return what a program prints; raise UnresolvableError where that is not known."""
        if not program.file.startswith("/"):
            raise UnresolvableError(f"{program.file[:80]}: the folder of the launch is not known")
        text = (
            self._file_text(program)
            if isinstance(program, CatCommand)
            else self._description(program)
        )
        return text if len(text) <= MAX_COMMAND_OUTPUT else self._shortened(text, program.file)

    def _shortened(self, text: str, file: str) -> str:
        """Return a robot that is too large to be held, without its shapes; this is noted."""
        try:
            short = shorten_description(text, file)
        except InputError:
            short = text
        if len(short) > MAX_COMMAND_OUTPUT:
            raise UnresolvableError(
                f"{file}: more than {MAX_COMMAND_OUTPUT} characters are printed"
            )
        why = f"its {len(text)} characters are too many to hold: it is read without its shapes"
        note = UnresolvedItem(what=Path(file).name, why=why, evidence=(Evidence(file=file),))
        if note not in self.unresolved:
            self.unresolved.append(note)
        return short

    def _file_text(self, program: CatCommand) -> str:
        try:
            return read_text_file(self.locate_source(program.file))
        except InputError as error:
            raise UnresolvableError(str(error)) from None

    def _description(self, program: XacroCommand) -> str:
        key = self.locate_source(program.file), tuple(sorted(program.mappings.items()))
        if key not in self._descriptions:
            if len(self._descriptions) == MAX_DESCRIPTIONS:
                raise UnresolvableError(f"more than {MAX_DESCRIPTIONS} robots are described")
            self._descriptions[key] = self._evaluate_xacro(Path(key[0]), program.mappings)
        description = self._descriptions[key]
        if isinstance(description, InputError):
            raise UnresolvableError(str(description))
        return description

    def _evaluate_xacro(self, path: Path, mappings: Mapping[str, str]) -> str | InputError:
        try:
            result = evaluate_xacro(path, mappings, self._share_folders(), self.environ)
        except InputError as error:
            return error
        self.unresolved.extend(result.unresolved)
        return result.text

    def _share_folders(self) -> dict[str, Path]:
        """Return where the packages of the workspace and of AMENT_PREFIX_PATH lie."""
        folders: dict[str, Path] = {}
        for prefix in filter(None, self.environ.get("AMENT_PREFIX_PATH", "").split(":")):
            share = Path(prefix) / "share"
            for folder in share.iterdir() if path_exists(share) and share.is_dir() else ():
                folders.setdefault(folder.name, folder)
        return {**folders, **self.packages}
