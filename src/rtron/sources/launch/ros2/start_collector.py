"""What a launch starts, taken with all that the graph of an app asks for."""

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path

from rtron.errors import InputError
from rtron.folders import is_there
from rtron.sources.code.frontends.python.lowering import MAX_BYTES
from rtron.sources.launch.ros2.action_context import Surroundings
from rtron.sources.launch.ros2.command_line import (
    is_run,
    remaps_in,
    run_node,
    special,
    split_pieces,
)
from rtron.sources.launch.ros2.inclusion import Place, evidence_of
from rtron.sources.launch.ros2.launch_context import Scope, canonical
from rtron.sources.launch.ros2.parameters.merge import ALL, ParameterSource
from rtron.sources.launch.ros2.parameters.node_configuration import Given
from rtron.sources.launch.ros2.result import Argument, Start, StartKind
from rtron.sources.launch.ros2.run import as_run
from rtron.sources.launch.ros2.shell import commands
from rtron.sources.launch.ros2.substitutions.template import has_hole, shown
from rtron.sources.launch.ros2.xml_yaml.element import Element
from rtron.vocabulary.remap_rules import UNKNOWN

SHARED = frozenset({"set_parameter", "set_parameters_from_file"})
"""The actions that give parameters to all nodes after them."""

_KINDS = {
    "node": StartKind.NODE,
    "lifecycle_node": StartKind.LIFECYCLE_NODE,
    "node_container": StartKind.CONTAINER,
}


@dataclass(slots=True)
class Starts(Surroundings):
    """Collects what a launch starts; `front` reads a Python launch file."""

    front: Callable[[str], Element] = field(kw_only=True)
    starts: list[Start] = field(default_factory=list)
    arguments: list[Argument] = field(default_factory=list)

    def python(self, path: str) -> Element:
        """Return what a Python launch file describes; raise InputError where there is none."""
        if not is_there(Path(path)) or not Path(path).is_file():
            raise InputError("is no file", path=path)
        if Path(path).stat().st_size > MAX_BYTES:
            raise InputError(f"larger than {MAX_BYTES // 2**20} MiB", path=path)
        return self.front(path)

    def node(self, element: Element, scope: Scope, place: Place) -> None:
        """Take a node, and what is to be loaded into it."""
        start = self._started(element, scope, place, _KINDS[element.tag])
        self.starts.append(start)
        self._components(element, scope, place, start.full_name)

    def components(self, element: Element, scope: Scope, place: Place) -> None:
        """Take the components that an action loads into a container."""
        target = self._text(element, "target", scope, place) or UNKNOWN
        self._components(element, scope, place, canonical(target))

    def _components(self, element: Element, scope: Scope, place: Place, container: str) -> None:
        for component in element.named("composable_node"):
            said, _ = self.evaluator.condition(component, scope, place)
            if said is not False:
                doubtful, scope.doubtful = scope.doubtful, scope.doubtful or said is None
                with self.under(component, scope, place, said):
                    start = self._started(component, scope, place, StartKind.COMPONENT)
                    extra = Given(self.evaluator, scope, place).extra_arguments(component)
                    self.starts.append(replace(start, container=container, extra=extra))
                scope.doubtful = doubtful

    def executable(self, element: Element, scope: Scope, place: Place) -> None:
        """Take a process, or each command of one that a shell runs; `ros2 run` starts a node."""
        words = self._words(as_run(element), "cmd", scope, place)
        for command in commands(words, shell=element.plain("shell").lower() == "true"):
            self.evaluator.bounds.node(place.path)
            self.starts.append(self._command(command, element, scope, place))

    def _command(self, words: Sequence[str], element: Element, scope: Scope, place: Place) -> Start:
        given = Given(self.evaluator, scope, place)
        found = Start(
            kind=StartKind.PROCESS,
            arguments=tuple(map(shown, words)),
            environ=given.environ(element),
            doubtful=scope.doubtful,
            **self.surroundings(element, place),
        )
        return _with(run_node(found), given.in_words(words, element)) if is_run(words) else found

    def unknown(self, element: Element, place: Place) -> None:
        """Note an action of a kind that is not known."""
        self.evaluator.note(element, place, "is not known here: what it starts is not known")

    def not_included(self, element: Element, spelled: str | None, place: Place) -> None:
        """Note that a file is not known which is included."""
        what = f"what it includes is not known: {shown(spelled or '')}"
        self.evaluator.note(element, place, what)

    def share(self, element: Element, scope: Scope, place: Place) -> None:
        """Give a parameter, or a file of them, to all nodes after this action."""
        source = Given(self.evaluator, scope, place).shared(element)
        if source is not None:
            scope.share_parameter(source)

    def declared(self, element: Element, scope: Scope, place: Place) -> None:
        """Take an argument that the root file declares."""
        if element.tag == "arg" and place.depth == 0:
            default = self._text(element, "default", scope, place)
            argument = Argument(
                name=element.plain("name"),
                default=default if "default" in element.attributes else None,
                description=element.plain("description"),
                evidence=evidence_of(element, place),
            )
            self.arguments.append(argument)

    def _started(self, element: Element, scope: Scope, place: Place, kind: StartKind) -> Start:
        self.evaluator.bounds.node(place.path)
        given = Given(self.evaluator, scope, place)
        words = self._arguments(element, scope, place)
        name, space = self._name(element, words, scope, place)
        early = [*remaps_in(words), *(scope.remaps or ())]
        remaps = self.evaluator.pairs(element.named("remap"), scope, place)
        start = Start(
            kind=kind,
            package=self._text(element, "pkg", scope, place),
            program=self._text(element, _program(kind), scope, place),
            name=name,
            namespace=space or "/",
            placed=bool(space),
            remaps=tuple((shown(name), shown(target)) for name, target in (*early, *remaps)),
            shared=len(early),
            arguments=tuple(map(shown, words)),
            environ=given.environ(element),
            doubtful=scope.doubtful,
            **self.surroundings(element, place),
        )
        pattern = start.full_name if name and space and kind is not StartKind.COMPONENT else ALL
        own = given.own(element, pattern)
        in_words = given.in_words(words, element)
        return _with(start, (*in_words, *(scope.parameters or ()), *own))

    def _name(
        self, element: Element, words: Sequence[str], scope: Scope, place: Place
    ) -> tuple[str, str | None]:
        """Return a node's name and namespace, None for none; those in its arguments count first."""
        name = self._text(element, "name", scope, place)
        written = "namespace" in element.attributes
        own = self._text(element, "namespace", scope, place) if written else None
        space = scope.space(own)
        named = special(words, "__node") or special(words, "__name") or name
        return named, special(words, "__ns") or (space and shown(space))

    def _arguments(self, element: Element, scope: Scope, place: Place) -> tuple[str, ...]:
        words = self._words(element, "args", scope, place)
        ros = self._words(element, "ros_args", scope, place)
        return (*words, "--ros-args", *ros) if ros else words

    def _words(self, element: Element, key: str, scope: Scope, place: Place) -> tuple[str, ...]:
        """Return the words of an attribute, and of the elements that are a word each."""
        listed = [self.text(one, "value", scope, place) for one in element.named(key)]
        substitution = self.evaluator.substitution(element, scope, place)
        with self.evaluator.noting(element, place):
            pieces = substitution.parsed(element.attributes.get(key, ""))
            return (*map(substitution.perform, split_pieces(pieces)), *listed)
        return tuple(listed)

    def _text(self, element: Element, key: str, scope: Scope, place: Place) -> str:
        return shown(self.text(element, key, scope, place))


def _with(start: Start, given: Iterable[ParameterSource]) -> Start:
    """Return what starts with its parameters, and whether all of them are known."""
    sources = tuple(given)
    complete = not any(has_hole(source.file) for source in sources)
    named = tuple(replace(source, file=shown(source.file)) for source in sources)
    return replace(start, sources=named, complete=complete)


def _program(kind: StartKind) -> str:
    return "plugin" if kind is StartKind.COMPONENT else "exec"
