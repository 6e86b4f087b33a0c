"""What a visit found as an AppLaunch: the same that reading the launch file makes."""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path

from rtron.sources.launch.ros2.command_line import (
    is_run,
    parameters_in,
    remaps_in,
    run_node,
    special,
)
from rtron.sources.launch.ros2.executed.rcl_arguments import Given
from rtron.sources.launch.ros2.executed.report import Component, Declared, Place, Process, Report
from rtron.sources.launch.ros2.executed.report_text import Marks
from rtron.sources.launch.ros2.launch_context import canonical
from rtron.sources.launch.ros2.parameters.merge import ParameterSource
from rtron.sources.launch.ros2.result import AppLaunch, Argument, Included, Start, StartKind
from rtron.sources.launch.ros2.shell import commands
from rtron.sources.launch.ros2.substitutions.template import shown
from rtron.vocabulary import Evidence, Unresolved


@dataclass(frozen=True, slots=True, kw_only=True)
class Launched:
    """Turns a report into what starts; files in `made` are there for the visit only."""

    report: Report
    marks: Marks
    made: Path

    def launch(self) -> AppLaunch:
        """Return what the launch file starts."""
        starts = tuple(start for one in self.report.starts for start in self._starts(one))
        notes = tuple(self._notes())
        return AppLaunch(
            file=self.marks.file,
            starts=starts,
            arguments=tuple(map(self._argument, self.report.arguments)),
            includes=tuple(self._includes()),
            unresolved=(*self.marks.evaluator.unresolved, *notes),
        )

    def _starts(self, one: Process | Component) -> Iterator[Start]:
        if isinstance(one, Component):
            yield self._component(one)
        elif one.kind == "process":
            yield from self._processes(one)
        else:
            yield self._node(one)

    def _node(self, one: Process) -> Start:
        given = self._given(one.place)
        words = self._words(one)
        early = tuple(remaps_in(words))
        space = special(words, "__ns") or self._special(one, "__ns")
        own = special(words, "__node") or special(words, "__name") or self._special(one, "__node")
        return Start(
            kind=StartKind(one.kind),
            package=self._text(one.package),
            program=self._text(one.program),
            name=own,
            namespace=space or "/",
            placed=bool(space),
            remaps=(*early, *given.rules(one.added)),
            shared=len(early) + one.shared,
            sources=(*parameters_in(words, given.place), *given.sources(one.added)),
            arguments=words,
            environ=self._environ(one),
            event=one.event,
            evidence=given.place,
            executed=True,
        )

    def _processes(self, one: Process) -> Iterator[Start]:
        """Yield a process, or each command of one that a shell runs."""
        given = self._given(one.place)
        for words in commands(one.words, shell=one.shell):
            self.marks.evaluator.bounds.node(self.marks.file)
            found = Start(
                kind=StartKind.PROCESS,
                arguments=tuple(map(self._text, words)),
                environ=self._environ(one),
                event=one.event,
                evidence=given.place,
                executed=True,
            )
            yield _node_of(found, given.sources(words)) if is_run(words) else found

    def _component(self, one: Component) -> Start:
        given = self._given(one.place)
        return Start(
            kind=StartKind.COMPONENT,
            package=self._text(one.package),
            program=self._text(one.program),
            name=self._text(one.name),
            namespace=self._text(one.namespace) or "/",
            placed=bool(one.namespace),
            remaps=tuple(given.pairs(one.remaps)),
            shared=one.shared,
            sources=given.component(one.parameters),
            container=canonical(self._text(one.container)),
            extra=given.named(one.extra),
            event=one.event,
            evidence=given.place,
            executed=True,
        )

    def _argument(self, one: Declared) -> Argument:
        return Argument(
            name=one.name,
            default=None if one.default is None else self._text(one.default),
            description=one.description,
            evidence=self._evidence(one.place),
        )

    def _includes(self) -> Iterator[Included]:
        for one in self.report.includes:
            given = tuple((self._text(name), self._text(value)) for name, value in one.arguments)
            place = self._evidence(one.place)
            yield Included(file=self.marks.path(one.file), arguments=given, evidence=place)

    def _notes(self) -> Iterator[Unresolved]:
        for one in self.report.notes:
            place = self._evidence(one.place)
            yield Unresolved(what=Path(place.file).name, why=self._text(one.why), evidence=(place,))

    def _words(self, one: Process) -> tuple[str, ...]:
        return tuple(map(self._text, one.words))

    def _special(self, one: Process, key: str) -> str:
        return special(tuple(map(self.marks.text, one.added)), key)

    def _environ(self, one: Process) -> tuple[tuple[str, str], ...]:
        return tuple((self._text(name), self._text(text)) for name, text in one.environ.items())

    def _given(self, place: Place) -> Given:
        return Given(marks=self.marks, made=self.made, place=self._evidence(place))

    def _evidence(self, place: Place) -> Evidence:
        return Evidence(file=self.marks.path(place.file) or self.marks.file, line=place.line)

    def _text(self, text: str) -> str:
        return shown(self.marks.text(text))


def _node_of(process: Start, sources: Iterator[ParameterSource]) -> Start:
    return replace(run_node(process), sources=tuple(sources))
