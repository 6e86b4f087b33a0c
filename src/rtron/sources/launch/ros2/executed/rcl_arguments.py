"""Remaps and parameters of what a visit found: as rcl reads them from a command line."""

import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from pathlib import Path

from rtron.errors import InputError
from rtron.sources.launch.ros2.executed.report import Value
from rtron.sources.launch.ros2.executed.report_text import ReportTexts
from rtron.sources.launch.ros2.limits import LaunchTooLargeError
from rtron.sources.launch.ros2.parameters.file import (
    parameter_entries,
    parse_value,
    parse_yaml_tree,
    read_text_file,
    string_value,
)
from rtron.sources.launch.ros2.parameters.merge import ALL_NODES, Entries, ParameterSource
from rtron.sources.launch.ros2.substitutions.template import display_text
from rtron.vocabulary import Evidence, ParameterValue, UnresolvedItem
from rtron.vocabulary.parameters import Parameter
from rtron.vocabulary.remap_rules import RemapRule

_TUPLE = re.compile(r"(?m):( &id[0-9]+)? !!python/tuple(?= \[\]$|$)")
"""How launch_ros writes lists into the files that it makes; rcl takes no notice of the tag."""
_NODE_NAME_RULES = ("__node:=", "__ns:=", "__name:=")


@dataclass(frozen=True, slots=True, kw_only=True)
class RclArguments:
    """Reads what launch adds to a command line.

    Files in `generated_folder` are there for the visit only.
    """

    texts: ReportTexts
    generated_folder: Path
    location: Evidence

    def remap_rules(self, words: Sequence[str]) -> Iterator[RemapRule]:
        """Yield the remap rules, without those that name the node."""
        yield from self.parse_rules(value for word, value in pairwise(words) if word == "-r")

    def parse_rules(self, rules: Iterable[str]) -> Iterator[RemapRule]:
        """Yield remap rules that are written `from:=to`."""
        for rule in rules:
            name, assignment, target = self.texts.resolve(rule).partition(":=")
            if assignment and not rule.startswith(_NODE_NAME_RULES):
                yield display_text(name), display_text(target)

    def parameter_sources(self, words: Sequence[str]) -> Iterator[ParameterSource]:
        """Yield the parameters, file by file and value by value."""
        for word, value in pairwise(words):
            name, assignment, text = value.partition(":=")
            if word in {"-p", "--param"} and assignment:
                yield self._source({name: parse_value(self.texts.resolve(text))})
            elif word == "--params-file":
                yield self._parameter_file(value)

    def named_parameters(self, values: Iterable[tuple[str, Value]]) -> dict[str, Parameter]:
        """Return parameters as a request to load a component has them."""
        return {
            display_text(self.texts.resolve(name)): self._parameter(self._value(value))
            for name, value in values
        }

    def component_parameters(
        self, values: Iterable[tuple[str, Value]]
    ) -> tuple[ParameterSource, ...]:
        """Return the parameters of a component; launch has put them together already."""
        parameters = self.named_parameters(values)
        return (ParameterSource(entries=((ALL_NODES, parameters),)),) if parameters else ()

    def _parameter_file(self, path: str) -> ParameterSource:
        """Return what a parameter file says; one that cannot be read is noted."""
        evaluator = self.texts.evaluator
        is_generated = Path(path).is_relative_to(self.generated_folder)
        entries: Entries = ()
        try:
            entries = self._generated_file(path) if is_generated else evaluator.files.entries(path)
        except LaunchTooLargeError:
            raise
        except InputError as error:
            note = UnresolvedItem(what=f"file {path}", why=str(error), evidence=(self.location,))
            evaluator.unresolved.append(note)
        file = "" if is_generated else self.texts.resolve_path(path)
        return ParameterSource(entries=tuple(self._relocated(entries, file)), file=file)

    def _generated_file(self, path: str) -> Entries:
        """Return what a file says that launch made; raise InputError where it is none."""
        text, bounds = read_text_file(path), self.texts.evaluator.limits
        bounds.count_bytes(path, len(text))
        return parameter_entries(parse_yaml_tree(_TUPLE.sub(r":\1", text), path), path)

    def _relocated(
        self, entries: Entries, file: str
    ) -> Iterator[tuple[str, Mapping[str, Parameter]]]:
        """Yield entries with the places that count here, and commands' output in their values."""
        for pattern, values in entries:
            relocated = {}
            for name, parameter in values.items():
                location = self.location
                if file and parameter.evidence is not None:
                    location = replace(parameter.evidence, file=file)
                relocated[name] = Parameter(value=self._value(parameter.value), evidence=location)
            yield pattern, relocated

    def _value(self, value: ParameterValue) -> ParameterValue:
        if isinstance(value, list):
            return [self._value(item) for item in value]
        return string_value(self.texts.resolve(value)) if isinstance(value, str) else value

    def _parameter(self, value: ParameterValue) -> Parameter:
        return Parameter(value=value, evidence=self.location)

    def _source(self, values: Mapping[str, ParameterValue]) -> ParameterSource:
        parameters = {name: self._parameter(value) for name, value in values.items()}
        return ParameterSource(entries=((ALL_NODES, parameters),))
