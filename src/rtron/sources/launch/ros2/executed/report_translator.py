"""What a visit found as an AppLaunch: the same that reading the launch file makes."""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path

from rtron.sources.launch.ros2.command_line import (
    argument_parameters,
    argument_remaps,
    is_ros2_run,
    node_of_ros2_run,
    special_remap,
)
from rtron.sources.launch.ros2.executed.rcl_arguments import RclArguments
from rtron.sources.launch.ros2.executed.report import (
    ReportedArgument,
    ReportedComponent,
    ReportedLocation,
    ReportedProcess,
    VisitReport,
)
from rtron.sources.launch.ros2.executed.report_text import ReportTexts
from rtron.sources.launch.ros2.launch_context import canonical_namespace
from rtron.sources.launch.ros2.parameters.merge import ParameterSource
from rtron.sources.launch.ros2.result import (
    AppLaunch,
    DeclaredArgument,
    IncludedFile,
    LaunchStart,
    StartKind,
)
from rtron.sources.launch.ros2.shell import split_commands
from rtron.sources.launch.ros2.substitutions.template import display_text
from rtron.vocabulary import Evidence, UnresolvedItem


@dataclass(frozen=True, slots=True, kw_only=True)
class ReportTranslator:
    """Turns a report into what starts; files in `generated_folder` are there for the visit only."""

    report: VisitReport
    texts: ReportTexts
    generated_folder: Path

    def launch(self) -> AppLaunch:
        """Return what the launch file starts."""
        starts = tuple(start for entry in self.report.starts for start in self._starts(entry))
        notes = tuple(self._notes())
        return AppLaunch(
            file=self.texts.file,
            starts=starts,
            arguments=tuple(map(self._argument, self.report.arguments)),
            includes=tuple(self._includes()),
            unresolved=(*self.texts.evaluator.unresolved, *notes),
        )

    def _starts(self, entry: ReportedProcess | ReportedComponent) -> Iterator[LaunchStart]:
        if isinstance(entry, ReportedComponent):
            yield self._component(entry)
        elif entry.kind == "process":
            yield from self._processes(entry)
        else:
            yield self._node(entry)

    def _node(self, entry: ReportedProcess) -> LaunchStart:
        rcl_arguments = self._rcl_arguments(entry.place)
        words = self._words(entry)
        argument_rules = tuple(argument_remaps(words))
        namespace = special_remap(words, "__ns") or self._special_remap(entry, "__ns")
        name = (
            special_remap(words, "__node")
            or special_remap(words, "__name")
            or self._special_remap(entry, "__node")
        )
        return LaunchStart(
            kind=StartKind(entry.kind),
            package=self._text(entry.package),
            program=self._text(entry.program),
            name=name,
            namespace=namespace or "/",
            has_namespace=bool(namespace),
            remaps=(*argument_rules, *rcl_arguments.remap_rules(entry.added)),
            parameter_sources=(
                *argument_parameters(words, rcl_arguments.location),
                *rcl_arguments.parameter_sources(entry.added),
            ),
            arguments=words,
            environ=self._environ_pairs(entry),
            awaited_event=entry.event,
            evidence=rcl_arguments.location,
            executed=True,
        )

    def _processes(self, entry: ReportedProcess) -> Iterator[LaunchStart]:
        """Yield a process, or each command of one that a shell runs."""
        rcl_arguments = self._rcl_arguments(entry.place)
        for words in split_commands(entry.words, shell=entry.shell):
            self.texts.evaluator.limits.count_node(self.texts.file)
            process = LaunchStart(
                kind=StartKind.PROCESS,
                arguments=tuple(map(self._text, words)),
                environ=self._environ_pairs(entry),
                awaited_event=entry.event,
                evidence=rcl_arguments.location,
                executed=True,
            )
            yield (
                _node_of_process(process, rcl_arguments.parameter_sources(words))
                if is_ros2_run(words)
                else process
            )

    def _component(self, entry: ReportedComponent) -> LaunchStart:
        rcl_arguments = self._rcl_arguments(entry.place)
        return LaunchStart(
            kind=StartKind.COMPONENT,
            package=self._text(entry.package),
            program=self._text(entry.program),
            name=self._text(entry.name),
            namespace=self._text(entry.namespace) or "/",
            has_namespace=bool(entry.namespace),
            remaps=tuple(rcl_arguments.parse_rules(entry.remaps)),
            parameter_sources=rcl_arguments.component_parameters(entry.parameters),
            container=canonical_namespace(self._text(entry.container)),
            extra_arguments=rcl_arguments.named_parameters(entry.extra),
            awaited_event=entry.event,
            evidence=rcl_arguments.location,
            executed=True,
        )

    def _argument(self, entry: ReportedArgument) -> DeclaredArgument:
        return DeclaredArgument(
            name=entry.name,
            default=None if entry.default is None else self._text(entry.default),
            description=entry.description,
            evidence=self._location(entry.place),
        )

    def _includes(self) -> Iterator[IncludedFile]:
        for entry in self.report.includes:
            arguments = tuple(
                (self._text(name), self._text(value)) for name, value in entry.arguments
            )
            location = self._location(entry.place)
            yield IncludedFile(
                file=self.texts.resolve_path(entry.file), arguments=arguments, evidence=location
            )

    def _notes(self) -> Iterator[UnresolvedItem]:
        for entry in self.report.notes:
            location = self._location(entry.place)
            yield UnresolvedItem(
                what=Path(location.file).name, why=self._text(entry.why), evidence=(location,)
            )

    def _words(self, entry: ReportedProcess) -> tuple[str, ...]:
        return tuple(map(self._text, entry.words))

    def _special_remap(self, entry: ReportedProcess, key: str) -> str:
        return special_remap(tuple(map(self.texts.resolve, entry.added)), key)

    def _environ_pairs(self, entry: ReportedProcess) -> tuple[tuple[str, str], ...]:
        return tuple((self._text(name), self._text(text)) for name, text in entry.environ.items())

    def _rcl_arguments(self, reported: ReportedLocation) -> RclArguments:
        return RclArguments(
            texts=self.texts,
            generated_folder=self.generated_folder,
            location=self._location(reported),
        )

    def _location(self, reported: ReportedLocation) -> Evidence:
        return Evidence(
            file=self.texts.resolve_path(reported.file) or self.texts.file, line=reported.line
        )

    def _text(self, text: str) -> str:
        return display_text(self.texts.resolve(text))


def _node_of_process(process: LaunchStart, sources: Iterator[ParameterSource]) -> LaunchStart:
    return replace(node_of_ros2_run(process), parameter_sources=tuple(sources))
