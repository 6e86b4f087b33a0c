"""What surrounds the actions of a launch: conditions, events, the files that include theirs."""

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from typing import Any

from rtron.sources.launch.ros2.evaluator import LaunchEvaluator
from rtron.sources.launch.ros2.inclusion import FileInclusion, element_location
from rtron.sources.launch.ros2.launch_context import LaunchContext
from rtron.sources.launch.ros2.result import IncludedFile
from rtron.sources.launch.ros2.substitutions.template import display_text, first_placeholder
from rtron.sources.launch.ros2.xml_yaml.element import Element
from rtron.vocabulary import Evidence


@dataclass(frozen=True, slots=True, kw_only=True)
class ActionContext:
    """The conditions that an action stands under, the event it waits for, the includes around."""

    conditions: tuple[Evidence, ...] = ()
    awaited_event: str = ""
    include_chain: tuple[Evidence, ...] = ()


@dataclass(slots=True)
class ActionContextTracker:
    """Keeps what surrounds the action that is being read, and what is included."""

    evaluator: LaunchEvaluator
    includes: list[list[IncludedFile]] = field(default_factory=lambda: [[]])
    _current: ActionContext = field(default_factory=ActionContext)

    def event_context(self, element: Element) -> ActionContext:
        """Return what surrounds the actions of a timer or an event."""
        return replace(self._current, awaited_event=element.plain_text("event") or element.tag)

    @contextmanager
    def in_context(self, action_context: ActionContext) -> Iterator[None]:
        """Read what runs later."""
        previous, self._current = self._current, action_context
        try:
            yield
        finally:
            self._current = previous

    @contextmanager
    def under_condition(
        self,
        element: Element,
        context: LaunchContext,
        file: FileInclusion,
        holds: bool | None,  # noqa: FBT001 - what its condition says
    ) -> Iterator[None]:
        """Read an action under its condition; one that is not known is noted."""
        if not {"if", "unless"} & element.attributes.keys():
            yield
            return
        if holds is None:
            texts = [self.text_or_empty(element, key, context, file) for key in ("if", "unless")]
            why = (
                f"whether it counts is not known ({first_placeholder(''.join(texts)) or 'refused'})"
            )
            self.evaluator.note(element, file, f"{why}, it is read as if it did")
        conditions = (*self._current.conditions, element_location(element, file))
        with self.in_context(replace(self._current, conditions=conditions)):
            yield

    @contextmanager
    def within_include(
        self, element: Element, path: str, context: LaunchContext, file: FileInclusion
    ) -> Iterator[None]:
        """Read an included file."""
        location = element_location(element, file)
        arguments = tuple(self._passed_arguments(element, context, file))
        self.includes.append([])
        try:
            with self.in_context(
                replace(self._current, include_chain=(*self._current.include_chain, location))
            ):
                yield
        finally:
            inner = tuple(self.includes.pop())
            included = IncludedFile(
                file=display_text(path), arguments=arguments, evidence=location, includes=inner
            )
            self.includes[-1].append(included)

    def _passed_arguments(
        self, element: Element, context: LaunchContext, file: FileInclusion
    ) -> Iterator[tuple[str, str]]:
        """Yield the arguments that an inclusion gives, and their values."""
        for argument in (*element.children_named("arg"), *element.children_named("let")):
            name = self.text_or_empty(argument, "name", context, file)
            yield display_text(name), display_text(context.configurations.get(name, ""))

    def text_or_empty(
        self, element: Element, key: str, context: LaunchContext, file: FileInclusion
    ) -> str:
        """Return an attribute's value, empty where there is none."""
        return self.evaluator.value(element, key, context, file) or ""

    def context_fields(self, element: Element, file: FileInclusion) -> dict[str, Any]:
        """Return what a Start says of where it stands."""
        current = self._current
        return {
            "conditions": current.conditions,
            "awaited_event": current.awaited_event,
            "include_chain": current.include_chain,
            "evidence": element_location(element, file),
        }
