"""Texts of a visit as they count here: what was not run, and where packages really lie."""

import re
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

from rtron.errors import InputError
from rtron.sources.launch.common.errors import UnresolvableError
from rtron.sources.launch.common.expression_library import anonymous_to_wildcard
from rtron.sources.launch.ros2.evaluator import LaunchEvaluator
from rtron.sources.launch.ros2.substitutions.substitution import MAX_GRAPH_TEXT
from rtron.sources.launch.ros2.substitutions.template import placeholder
from rtron.vocabulary import Evidence, UnresolvedItem

_MARK = re.compile("rtron_command_([0-9]{1,9})_output")


@dataclass(slots=True, kw_only=True)
class ReportTexts:
    """Puts what commands print in the place of their marks; `file` is the launch file.

    `prefix` is where the packages of the source were to be found, as if they were installed.
    """

    commands: tuple[str, ...]
    file: str
    prefix: str
    packages: Mapping[str, Path]
    evaluator: LaunchEvaluator
    _outputs: dict[int, str] = field(init=False)

    def __post_init__(self) -> None:
        """Look at each command, whether its mark is still there or not."""
        self._outputs = {n: self._output(command) for n, command in enumerate(self.commands)}

    def resolve(self, text: str) -> str:
        """Return a text as launch would have it, a hole for what is not known."""
        numbers = [int(number) for number in _MARK.findall(text)]
        if numbers:
            long = sum(len(self._command_output(number)) for number in numbers) > MAX_GRAPH_TEXT
            if long and _MARK.fullmatch(text) is None:
                return placeholder("a long text")
            text = _MARK.sub(lambda mark: self._command_output(int(mark[1])), text)
        return anonymous_to_wildcard(self.resolve_path(text))

    def resolve_path(self, text: str) -> str:
        """Return a text with packages where their source lies."""
        if self.prefix not in text:
            return text
        pattern = re.escape(f"{self.prefix}/share/") + r"([\w.-]+)"
        return re.sub(pattern, lambda found: self._share_folder(found[1], found[0]), text)

    def _share_folder(self, package: str, otherwise: str) -> str:
        return str(self.packages.get(package, otherwise))

    def _command_output(self, number: int) -> str:
        return self._outputs[number] if number in self._outputs else placeholder("?")

    def _output(self, command: str) -> str:
        try:
            return self.evaluator.command_output.output_of_line(self.resolve_path(command))
        except (UnresolvableError, InputError) as error:
            location = Evidence(file=self.file)
            what = f"command {command[:80]}"
            note = UnresolvedItem(what=what, why=str(error), evidence=(location,))
            self.evaluator.unresolved.append(note)
            return placeholder(what)
