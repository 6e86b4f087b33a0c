"""The robot descriptions that a launch evaluates, remembered for those who look for plugins."""

import os
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import TypeAlias

from rtron.errors import InputError
from rtron.sources.launch.common.packages import PackageIndex
from rtron.sources.xacro.robot_description import XacroResult, evaluate_xacro
from rtron.vocabulary import UnknownValue

_Key: TypeAlias = tuple[str, tuple[tuple[str, str], ...]]


@dataclass(slots=True, kw_only=True)
class RobotDescriptions:
    """Evaluates descriptions, each file with the same arguments once."""

    packages: PackageIndex
    environ: Mapping[str, str] = field(default_factory=lambda: os.environ)
    _results: dict[_Key, XacroResult | InputError] = field(default_factory=dict)
    _by_text: dict[str, XacroResult] = field(default_factory=dict)

    def describe(self, path: str | Path, args: Mapping[str, str]) -> str | UnknownValue:
        """Return what `xacro PATH name:=value …` would print, or why that is not known."""
        result = self.evaluate_file(path, args)
        return UnknownValue(str(result)) if isinstance(result, InputError) else result.text

    def evaluate_file(self, path: str | Path, args: Mapping[str, str]) -> XacroResult | InputError:
        """Return the description of a file, or what is wrong with the file."""
        key = (str(path), tuple(sorted(args.items())))
        if key not in self._results:
            self._results[key] = self._evaluate(Path(path), args)
        return self._results[key]

    def result_of_text(self, text: str) -> XacroResult | None:
        """Return the description whose text `describe` gave, None if it was another's."""
        return self._by_text.get(text)

    def results(self) -> tuple[XacroResult, ...]:
        """Return every description evaluated so far, in the order of the first demand."""
        return tuple(each for each in self._results.values() if isinstance(each, XacroResult))

    def _evaluate(self, path: Path, args: Mapping[str, str]) -> XacroResult | InputError:
        try:
            result = evaluate_xacro(path, args, self.packages, self.environ)
        except InputError as error:
            return error
        self._by_text.setdefault(result.text, result)
        return result
