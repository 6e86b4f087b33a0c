"""What surrounds the actions of a launch: conditions, events, the files that include theirs."""

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from typing import Any

from rtron.sources.launch.ros2.evaluator import Evaluator
from rtron.sources.launch.ros2.inclusion import Place, evidence_of
from rtron.sources.launch.ros2.launch_context import Scope
from rtron.sources.launch.ros2.result import Included
from rtron.sources.launch.ros2.substitutions.template import first_hole, shown
from rtron.sources.launch.ros2.xml_yaml.element import Element
from rtron.vocabulary import Evidence


@dataclass(frozen=True, slots=True, kw_only=True)
class Setting:
    """The conditions that an action stands under, the event it waits for, the includes around."""

    conditions: tuple[Evidence, ...] = ()
    event: str = ""
    chain: tuple[Evidence, ...] = ()


@dataclass(slots=True)
class Surroundings:
    """Keeps what surrounds the action that is being read, and what is included."""

    evaluator: Evaluator
    includes: list[list[Included]] = field(default_factory=lambda: [[]])
    _around: Setting = field(default_factory=Setting)

    def setting(self, element: Element) -> Setting:
        """Return what surrounds the actions of a timer or an event."""
        return replace(self._around, event=element.plain("event") or element.tag)

    @contextmanager
    def later(self, setting: Setting) -> Iterator[None]:
        """Read what runs later."""
        before, self._around = self._around, setting
        try:
            yield
        finally:
            self._around = before

    @contextmanager
    def under(
        self,
        element: Element,
        scope: Scope,
        place: Place,
        said: bool | None,  # noqa: FBT001 - what its condition says
    ) -> Iterator[None]:
        """Read an action under its condition; one that is not known is noted."""
        if not {"if", "unless"} & element.attributes.keys():
            yield
            return
        if said is None:
            texts = [self.text(element, key, scope, place) for key in ("if", "unless")]
            why = f"whether it counts is not known ({first_hole(''.join(texts)) or 'refused'})"
            self.evaluator.note(element, place, f"{why}, it is read as if it did")
        conditions = (*self._around.conditions, evidence_of(element, place))
        with self.later(replace(self._around, conditions=conditions)):
            yield

    @contextmanager
    def within(self, element: Element, path: str, scope: Scope, place: Place) -> Iterator[None]:
        """Read an included file."""
        own = evidence_of(element, place)
        given = tuple(self._given(element, scope, place))
        self.includes.append([])
        try:
            with self.later(replace(self._around, chain=(*self._around.chain, own))):
                yield
        finally:
            inner = tuple(self.includes.pop())
            found = Included(file=shown(path), arguments=given, evidence=own, includes=inner)
            self.includes[-1].append(found)

    def _given(self, element: Element, scope: Scope, place: Place) -> Iterator[tuple[str, str]]:
        """Yield the arguments that an inclusion gives, and their values."""
        for argument in (*element.named("arg"), *element.named("let")):
            name = self.text(argument, "name", scope, place)
            yield shown(name), shown(scope.configurations.get(name, ""))

    def text(self, element: Element, key: str, scope: Scope, place: Place) -> str:
        """Return an attribute's value, empty where there is none."""
        return self.evaluator.value(element, key, scope, place) or ""

    def surroundings(self, element: Element, place: Place) -> dict[str, Any]:
        """Return what a Start says of where it stands."""
        around = self._around
        return {
            "conditions": around.conditions,
            "event": around.event,
            "chain": around.chain,
            "evidence": evidence_of(element, place),
        }
