"""Remaps and parameters of what a visit found: as rcl reads them from a command line."""

import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from pathlib import Path

from rtron.errors import InputError
from rtron.sources.launch.ros2.executed.report import Value
from rtron.sources.launch.ros2.executed.report_text import Marks
from rtron.sources.launch.ros2.limits import TooMuchError
from rtron.sources.launch.ros2.parameters.file import (
    entries_of,
    read_text,
    text_value,
    tree_of,
    yaml_value,
)
from rtron.sources.launch.ros2.parameters.merge import ALL, Entries, ParameterSource
from rtron.sources.launch.ros2.substitutions.template import shown
from rtron.vocabulary import Evidence, ParameterValue, Unresolved
from rtron.vocabulary.parameters import Parameter
from rtron.vocabulary.remap_rules import Rule

_TUPLE = re.compile(r"(?m):( &id[0-9]+)? !!python/tuple(?= \[\]$|$)")
"""How launch_ros writes lists into the files that it makes; rcl takes no notice of the tag."""
_SPECIAL = ("__node:=", "__ns:=", "__name:=")


@dataclass(frozen=True, slots=True, kw_only=True)
class Given:
    """Reads what launch adds to a command line; files in `made` are there for the visit only."""

    marks: Marks
    made: Path
    place: Evidence

    def rules(self, words: Sequence[str]) -> Iterator[Rule]:
        """Yield the remap rules, without those that name the node."""
        yield from self.pairs(value for word, value in pairwise(words) if word == "-r")

    def pairs(self, rules: Iterable[str]) -> Iterator[Rule]:
        """Yield remap rules that are written `from:=to`."""
        for rule in rules:
            name, given, target = self.marks.text(rule).partition(":=")
            if given and not rule.startswith(_SPECIAL):
                yield shown(name), shown(target)

    def sources(self, words: Sequence[str]) -> Iterator[ParameterSource]:
        """Yield the parameters, file by file and value by value."""
        for word, value in pairwise(words):
            name, given, text = value.partition(":=")
            if word in {"-p", "--param"} and given:
                yield self._source({name: yaml_value(self.marks.text(text))})
            elif word == "--params-file":
                yield self._file(value)

    def named(self, values: Iterable[tuple[str, Value]]) -> dict[str, Parameter]:
        """Return parameters as a request to load a component has them."""
        return {
            shown(self.marks.text(name)): self._parameter(self._value(value))
            for name, value in values
        }

    def component(self, values: Iterable[tuple[str, Value]]) -> tuple[ParameterSource, ...]:
        """Return the parameters of a component; launch has put them together already."""
        found = self.named(values)
        return (ParameterSource(entries=((ALL, found),)),) if found else ()

    def _file(self, path: str) -> ParameterSource:
        """Return what a parameter file says; one that cannot be read is noted."""
        evaluator, is_made = self.marks.evaluator, Path(path).is_relative_to(self.made)
        entries: Entries = ()
        try:
            entries = self._made(path) if is_made else evaluator.files.entries(path)
        except TooMuchError:
            raise
        except InputError as error:
            note = Unresolved(what=f"file {path}", why=str(error), evidence=(self.place,))
            evaluator.unresolved.append(note)
        file = "" if is_made else self.marks.path(path)
        return ParameterSource(entries=tuple(self._moved(entries, file)), file=file)

    def _made(self, path: str) -> Entries:
        """Return what a file says that launch made; raise InputError where it is none."""
        text, bounds = read_text(path), self.marks.evaluator.bounds
        bounds.size(path, len(text))
        return entries_of(tree_of(_TUPLE.sub(r":\1", text), path), path)

    def _moved(self, entries: Entries, file: str) -> Iterator[tuple[str, Mapping[str, Parameter]]]:
        """Yield entries with the places that count here, and commands' output in their values."""
        for pattern, values in entries:
            moved = {}
            for name, one in values.items():
                place = self.place
                if file and one.evidence is not None:
                    place = replace(one.evidence, file=file)
                moved[name] = Parameter(value=self._value(one.value), evidence=place)
            yield pattern, moved

    def _value(self, value: ParameterValue) -> ParameterValue:
        if isinstance(value, list):
            return [self._value(item) for item in value]
        return text_value(self.marks.text(value)) if isinstance(value, str) else value

    def _parameter(self, value: ParameterValue) -> Parameter:
        return Parameter(value=value, evidence=self.place)

    def _source(self, values: Mapping[str, ParameterValue]) -> ParameterSource:
        found = {name: self._parameter(value) for name, value in values.items()}
        return ParameterSource(entries=((ALL, found),))
