"""What a launch starts, taken with all that the graph of an app asks for."""

from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

from rtron.errors import InputError
from rtron.folders import is_there
from rtron.sources.launch2.element import Element
from rtron.sources.launch2.evaluator import Evaluator
from rtron.sources.launch2.given import Given
from rtron.sources.launch2.place import Place, evidence_of
from rtron.sources.launch2.pieces import first_hole, has_hole, shown
from rtron.sources.launch2.result import Argument, Included, Start, StartKind
from rtron.sources.launch2.scope import Scope, canonical
from rtron.sources.launch2.words import (
    RUN,
    parameters_in,
    remaps_in,
    run_node,
    special,
    split_words,
)
from rtron.vocabulary import Evidence
from rtron.vocabulary.remap_rules import UNKNOWN

SHARED = frozenset({"set_parameter", "set_parameters_from_file", "set_use_sim_time"})
"""The actions that give parameters to all nodes after them."""

_KINDS = {
    "node": StartKind.NODE,
    "lifecycle_node": StartKind.LIFECYCLE_NODE,
    "node_container": StartKind.CONTAINER,
}


@dataclass(frozen=True, slots=True, kw_only=True)
class Setting:
    """What surrounds an action: the conditions it stands under, its event, the includes."""

    conditions: tuple[Evidence, ...] = ()
    event: str = ""
    chain: tuple[Evidence, ...] = ()


@dataclass(slots=True)
class Starts:
    """Collects what a launch starts; `front` reads a Python launch file."""

    evaluator: Evaluator
    front: Callable[[str], Element]
    starts: list[Start] = field(default_factory=list)
    arguments: list[Argument] = field(default_factory=list)
    includes: list[list[Included]] = field(default_factory=lambda: [[]])
    _around: Setting = field(default_factory=Setting)

    def python(self, path: str) -> Element:
        """Return what a Python launch file describes; raise InputError where there is none."""
        if not is_there(Path(path)) or not Path(path).is_file():
            raise InputError("is no file", path=path)
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
                    extra = Given(self.evaluator, scope, place).extra(component)
                    self.starts.append(replace(start, container=container, extra=extra))
                scope.doubtful = doubtful

    def executable(self, element: Element, scope: Scope, place: Place) -> None:
        """Take a process; `ros2 run` starts a node."""
        words = self._words(element, "cmd", scope, place)
        words = tuple(split_words(words[0])) if len(words) == 1 else words
        given = Given(self.evaluator, scope, place)
        found = Start(
            kind=StartKind.PROCESS,
            arguments=tuple(map(shown, words)),
            environ=given.environ(element),
            doubtful=scope.doubtful,
            **self._surroundings(element, place),
        )
        self.evaluator.bounds.node(place.path)
        self.starts.append(run_node(found) if words[: len(RUN)] == RUN else found)

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

    def setting(self, element: Element) -> Setting:
        """Return what surrounds the actions of a timer or an event."""
        return replace(self._around, event=element.plain("event") or element.tag)

    @contextmanager
    def later(self, setting: Setting) -> Iterator[None]:
        """Read what runs later."""
        with self._within(setting):
            yield

    @contextmanager
    def under(
        self,
        element: Element,
        scope: Scope,
        place: Place,
        said: bool | None,  # noqa: FBT001
    ) -> Iterator[None]:
        """Read an action under its condition; one that is not known is noted."""
        if not {"if", "unless"} & element.attributes.keys():
            yield
            return
        own = evidence_of(element, place)
        if said is None:
            texts = [self._value(element, key, scope, place) for key in ("if", "unless")]
            why = f"whether it counts is not known ({first_hole(''.join(texts)) or 'refused'})"
            self.evaluator.note(element, place, f"{why}, it is read as if it did")
        with self._within(replace(self._around, conditions=(*self._around.conditions, own))):
            yield

    @contextmanager
    def within(self, element: Element, path: str, scope: Scope, place: Place) -> Iterator[None]:
        """Read an included file."""
        own = evidence_of(element, place)
        self.includes.append([])
        try:
            with self._within(replace(self._around, chain=(*self._around.chain, own))):
                yield
        finally:
            inner = tuple(self.includes.pop())
            given = (*element.named("arg"), *element.named("let"))
            names = [self._text(one, "name", scope, place) for one in given]
            values = [scope.configurations.get(name, "") for name in names]
            pairs = tuple(zip(names, map(shown, values), strict=True))
            found = Included(file=shown(path), arguments=pairs, evidence=own, includes=inner)
            self.includes[-1].append(found)

    @contextmanager
    def _within(self, setting: Setting) -> Iterator[None]:
        before, self._around = self._around, setting
        try:
            yield
        finally:
            self._around = before

    def _started(self, element: Element, scope: Scope, place: Place, kind: StartKind) -> Start:
        self.evaluator.bounds.node(place.path)
        given = Given(self.evaluator, scope, place)
        words = self._arguments(element, scope, place)
        name, own = self._name(element, words, scope, place)
        early = [*remaps_in(words), *(scope.remaps or ())]
        remaps = self.evaluator.pairs(element.named("remap"), scope, place)
        start = Start(
            kind=kind,
            package=self._text(element, "pkg", scope, place),
            program=self._text(element, _program(kind), scope, place),
            name=name,
            namespace=own,
            remaps=tuple((shown(name), shown(target)) for name, target in (*early, *remaps)),
            shared=len(early),
            arguments=tuple(map(shown, words)),
            environ=given.environ(element),
            doubtful=scope.doubtful,
            **self._surroundings(element, place),
        )
        sources = (*parameters_in(words), *(scope.parameters or ()), *given.own(element, start))
        return replace(start, sources=sources, complete=not any(has_hole(s.file) for s in sources))

    def _name(
        self, element: Element, words: Sequence[str], scope: Scope, place: Place
    ) -> tuple[str, str]:
        """Return a node's name and namespace; those among its arguments count first."""
        name = self._text(element, "name", scope, place)
        written = "namespace" in element.attributes
        own = self._text(element, "namespace", scope, place) if written else None
        space = special(words, "__ns") or shown(scope.space(own) or "/")
        return special(words, "__node") or special(words, "__name") or name, space

    def _arguments(self, element: Element, scope: Scope, place: Place) -> tuple[str, ...]:
        words = self._words(element, "args", scope, place)
        ros = self._words(element, "ros_args", scope, place)
        return (*words, "--ros-args", *ros) if ros else words

    def _words(self, element: Element, key: str, scope: Scope, place: Place) -> tuple[str, ...]:
        """Return the words of an attribute, and of the elements that are a word each."""
        text = self.evaluator.value(element, key, scope, place) or ""
        words = [self._value(one, "value", scope, place) for one in element.named(key)]
        return (*split_words(text), *words)

    def _text(self, element: Element, key: str, scope: Scope, place: Place) -> str:
        return shown(self._value(element, key, scope, place))

    def _value(self, element: Element, key: str, scope: Scope, place: Place) -> str:
        return self.evaluator.value(element, key, scope, place) or ""

    def _surroundings(self, element: Element, place: Place) -> dict[str, Any]:
        around = self._around
        return {
            "conditions": around.conditions,
            "event": around.event,
            "chain": around.chain,
            "evidence": evidence_of(element, place),
        }


def _program(kind: StartKind) -> str:
    return "plugin" if kind is StartKind.COMPONENT else "exec"
