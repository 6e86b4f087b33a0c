"""Texts of a visit as they count here: what was not run, and where packages really lie."""

import re
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

from rtron.errors import InputError
from rtron.sources.launch.common.errors import UnresolvableError
from rtron.sources.launch.ros1.substitution_args import as_pattern
from rtron.sources.launch.ros2.evaluator import Evaluator
from rtron.sources.launch.ros2.substitutions.substitution import MAX_LONG
from rtron.sources.launch.ros2.substitutions.template import hole
from rtron.vocabulary import Evidence, Unresolved

_MARK = re.compile("\ue000([0-9]{1,9})\ue001")


@dataclass(slots=True, kw_only=True)
class Marks:
    """Puts what commands print in the place of their marks; `file` is the launch file.

    `prefix` is where the packages of the source were to be found, as if they were installed.
    """

    commands: tuple[str, ...]
    file: str
    prefix: str
    packages: Mapping[str, Path]
    evaluator: Evaluator
    _printed: dict[int, str] = field(init=False)

    def __post_init__(self) -> None:
        """Look at each command, whether its mark is still there or not."""
        self._printed = {n: self._output(one) for n, one in enumerate(self.commands)}

    def text(self, text: str) -> str:
        """Return a text as launch would have it, a hole for what is not known."""
        numbers = [int(number) for number in _MARK.findall(text)]
        if numbers:
            long = sum(len(self._command(number)) for number in numbers) > MAX_LONG
            if long and _MARK.fullmatch(text) is None:
                return hole("a long text")
            text = _MARK.sub(lambda mark: self._command(int(mark[1])), text)
        return as_pattern(self.path(text))

    def path(self, text: str) -> str:
        """Return a text with packages where their source lies."""
        if self.prefix not in text:
            return text
        pattern = re.escape(f"{self.prefix}/share/") + r"([\w.-]+)"
        return re.sub(pattern, lambda found: self._share(found[1], found[0]), text)

    def _share(self, package: str, otherwise: str) -> str:
        return str(self.packages.get(package, otherwise))

    def _command(self, number: int) -> str:
        return self._printed[number] if number in self._printed else hole("?")

    def _output(self, command: str) -> str:
        try:
            return self.evaluator.commands.printed(self.path(command))
        except (UnresolvableError, InputError) as error:
            place = Evidence(file=self.file)
            what = f"command {command[:80]}"
            note = Unresolved(what=what, why=str(error), evidence=(place,))
            self.evaluator.unresolved.append(note)
            return hole(what)
