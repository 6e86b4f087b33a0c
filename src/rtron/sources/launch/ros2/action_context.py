"""The conditions, events and includes around the actions of a launch."""

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field, replace

from rtron.sources.launch.ros2.element_site import ElementSite
from rtron.sources.launch.ros2.evaluator import LaunchEvaluator
from rtron.sources.launch.ros2.result import IncludedFile
from rtron.sources.launch.ros2.substitutions.template import display_text, first_placeholder
from rtron.sources.launch.ros2.xml_yaml.element import Element
from rtron.vocabulary import Evidence
from rtron.wording import join_names


@dataclass(frozen=True, slots=True, kw_only=True)
class ActionContext:
    """The conditions that an action stands under, the event it waits for, the includes around."""

    conditions: tuple[Evidence, ...] = ()
    awaited_event: str = ""
    include_chain: tuple[Evidence, ...] = ()


@dataclass(slots=True)
class ActionContextTracker:
    """Knows the context of the action that is being read, and collects what is included."""

    evaluator: LaunchEvaluator
    current: ActionContext = field(default_factory=ActionContext)
    _includes: list[list[IncludedFile]] = field(default_factory=lambda: [[]])

    @property
    def includes(self) -> tuple[IncludedFile, ...]:
        """The files that the root file includes."""
        return tuple(self._includes[0])

    def event_context(self, element: Element) -> ActionContext:
        """Return the context of the actions of a timer or an event."""
        return replace(self.current, awaited_event=element.plain_text("event") or element.tag)

    @contextmanager
    def in_context(self, action_context: ActionContext) -> Iterator[None]:
        """Read actions in another context."""
        previous, self.current = self.current, action_context
        try:
            yield
        finally:
            self.current = previous

    @contextmanager
    def record_condition(self, site: ElementSite, holds: bool | None) -> Iterator[None]:  # noqa: FBT001
        """Read an action under its condition; one that is not known is noted."""
        if not site.has("if") and not site.has("unless"):
            yield
            return
        if holds is None and self.evaluator.symbolic:
            self._note_unknown_condition(site)
        conditions = (*self.current.conditions, site.location)
        with self.in_context(replace(self.current, conditions=conditions)):
            yield

    def _note_unknown_condition(self, site: ElementSite) -> None:
        unknown, deciding = "refused", set[str]()
        for key in ("if", "unless"):
            text = self.evaluator.value(site, key) or ""
            unknown = first_placeholder(text) or unknown
            deciding |= {each.name for each in self.evaluator.dependencies} - {unknown}
        why = f"whether it counts is not known ({unknown}), it is read as if it did"
        hint = f"; what is given for {join_names(sorted(deciding))} may decide" if deciding else ""
        self.evaluator.note(site, why + hint)

    @contextmanager
    def within_include(self, site: ElementSite, path: str) -> Iterator[None]:
        """Read an included file."""
        arguments = tuple(self._passed_arguments(site))
        chain = (*self.current.include_chain, site.location)
        self._includes.append([])
        try:
            with self.in_context(replace(self.current, include_chain=chain)):
                yield
        finally:
            included = IncludedFile(
                file=display_text(path),
                arguments=arguments,
                evidence=site.location,
                includes=tuple(self._includes.pop()),
            )
            self._includes[-1].append(included)

    def _passed_arguments(self, site: ElementSite) -> Iterator[tuple[str, str]]:
        """Yield the arguments that an inclusion gives, and their values."""
        if not self.evaluator.symbolic:
            return  # to evaluate them again would note each error twice
        for argument in site.children("arg", "let"):
            name = self.evaluator.value(argument, "name") or ""
            yield display_text(name), display_text(site.context.configurations.get(name, ""))
