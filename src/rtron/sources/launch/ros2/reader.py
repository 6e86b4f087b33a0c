"""ROS 2's launch files, evaluated: nodes, their namespaces and their remaps.

Sources: docs.ros.org, launch file formats; the docstrings of launch and launch_ros, and what both
do when they run. Nothing is run. `read_ros2_launch` is for the guarded launch: it looks into no
Python launch file, which stands in the tree without nodes. `app.read_app_launch` looks into all.
"""

import os.path
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field
from heapq import heappop, heappush
from math import inf
from pathlib import Path

from rtron.errors import InputError
from rtron.sources.launch.common.errors import MissingArgumentError
from rtron.sources.launch.ros2.action_context import ActionContext
from rtron.sources.launch.ros2.bundled_files import GAZEBO_ACTIONS, as_include, bundled_launch_file
from rtron.sources.launch.ros2.choices import LaunchChoices
from rtron.sources.launch.ros2.context_actions import CONTEXT_TAGS, IGNORED_TAGS, ContextActions
from rtron.sources.launch.ros2.evaluator import LaunchEvaluator
from rtron.sources.launch.ros2.inclusion import FileInclusion
from rtron.sources.launch.ros2.launch_context import LaunchContext
from rtron.sources.launch.ros2.limits import MAX_INCLUDE_DEPTH
from rtron.sources.launch.ros2.node_collector import LaunchNodeCollector
from rtron.sources.launch.ros2.start_collector import GLOBAL_PARAMETER_TAGS, StartCollector
from rtron.sources.launch.ros2.substitutions.loops import (
    LOOPS,
    UNKNOWN_COUNT,
    UNKNOWN_ITERATION,
    iterations_of,
)
from rtron.sources.launch.ros2.substitutions.template import has_placeholder
from rtron.sources.launch.ros2.xml_yaml.element import Element, parse_elements
from rtron.vocabulary import LaunchTree

_NODE_TAGS = frozenset({"node", "lifecycle_node", "node_container"})
_EVENT_TAGS = frozenset({"timer", "ros_timer", "event_handler"})
_STARTING_TAGS = (
    _NODE_TAGS
    | _EVENT_TAGS
    | GAZEBO_ACTIONS
    | {"load_composable_node", "group", "include", "composable_node", "function", "executable"}
)
_FALSE = frozenset({"false", "no", "off"})


def read_ros2_launch(
    path: Path,
    arguments: Mapping[str, str],
    environ: Mapping[str, str],
    packages: Mapping[str, Path],
) -> LaunchTree:
    """Return what a launch file starts; raise InputError where launch would refuse it.

    `arguments` are those of the command line, `packages` where packages lie. What cannot be
    evaluated is noted: a condition then counts as true, a name or namespace has a `*`.
    """
    choices = LaunchChoices(arguments=arguments, environ=environ)
    evaluator = LaunchEvaluator(environ=environ, packages=packages, choices=choices)
    context = LaunchContext(dict(arguments), dict(environ))
    try:
        file = LaunchReader(evaluator, LaunchNodeCollector(evaluator)).root(
            absolute_path(path), context
        )
    except MissingArgumentError as error:
        help = f"add {error.name}:=…"
        raise InputError(str(error), path=str(path), help=help) from None
    return LaunchTree(
        root=file.launch_file(), unresolved=tuple(evaluator.unresolved), inputs=choices.all()
    )


def absolute_path(path: Path | str) -> str:
    """Return a path as launch spells it, no links followed."""
    return os.path.abspath(path)  # noqa: PTH100 - a string


@dataclass(frozen=True, slots=True, order=True)
class _Timer:
    """Actions that run later, `due` seconds after the start; `number` counts the timers."""

    due: float
    number: int
    element: Element = field(compare=False)
    file: FileInclusion = field(compare=False)
    is_uncertain: bool = field(compare=False)
    action_context: ActionContext = field(compare=False)


@dataclass(slots=True)
class LaunchReader:
    """Walks through launch files; `nodes` takes what they start."""

    _evaluator: LaunchEvaluator
    _collector: LaunchNodeCollector | StartCollector
    _timers: list[_Timer] = field(default_factory=list)
    _elements_by_path: dict[str, Element] = field(default_factory=dict)
    _time: float = 0.0

    def root(self, path: str, context: LaunchContext) -> FileInclusion:
        """Read a launch file and all that it includes."""
        file = self._file(path, context, 0)
        while self._timers:
            # It runs when the groups and files around it are left: in what is then the one scope.
            timer = heappop(self._timers)
            self._time, context.is_uncertain = timer.due, timer.is_uncertain
            with self._collector.in_context(timer.action_context):
                self._actions(timer.element.children, context, timer.file)
        return file

    def _file(self, path: str, context: LaunchContext, depth: int) -> FileInclusion:
        if depth > MAX_INCLUDE_DEPTH:
            raise InputError(f"{MAX_INCLUDE_DEPTH} files include each other", path=path)
        file = FileInclusion(path, depth)
        self._evaluator.limits.count_file(path)
        root = self._root(path)
        if root is not None:
            self._evaluator.limits.count_bytes(path, Path(path).stat().st_size)
            self._actions(root.children, context, file)
        return file

    def _root(self, path: str) -> Element | None:
        """Return a file's actions; a Python file is read anew each time, as it is run."""
        if path.endswith(".py"):
            return self._collector.read_python(path)
        if path not in self._elements_by_path:
            self._elements_by_path[path] = parse_elements(path)
        return self._elements_by_path[path]

    def _actions(
        self, elements: Iterable[Element], context: LaunchContext, file: FileInclusion
    ) -> None:
        self._evaluator.limits.enter_level(file.path)
        for element in elements:
            self._conditional_action(element, context, file)
        self._evaluator.limits.level -= 1

    def _conditional_action(
        self, element: Element, context: LaunchContext, file: FileInclusion
    ) -> None:
        """Read an action if its condition lets it run; another value of it may be refused later."""
        self._evaluator.limits.count_action(file.path, context)
        holds, dependencies = self._evaluator.condition(element, context, file)
        changes_context, starts = element.tag in CONTEXT_TAGS, element.tag in _STARTING_TAGS
        if changes_context or (starts and holds is False):
            self._evaluator.choices.decide(dependencies)
        if holds is False:
            return
        before, outer_uncertain = context.change_mark(), context.is_uncertain
        context.is_uncertain = outer_uncertain or (holds is None and not changes_context)
        with self._collector.under_condition(element, context, file, holds):
            self._action(element, context, file, holds)
        context.is_uncertain = outer_uncertain
        if starts and context.add_dependencies(dependencies, before):
            self._evaluator.choices.decide(dependencies)

    def _action(
        self,
        element: Element,
        context: LaunchContext,
        file: FileInclusion,
        holds: bool | None,  # noqa: FBT001 - what its condition says
    ) -> None:
        handler = self._readers.get(element.tag)
        if element.tag in LOOPS and self._evaluator.symbolic:
            # A guarded launch has none: its nodes could not have remaps of their own.
            self._loop(element, context, file)
        elif element.tag in GAZEBO_ACTIONS and self._evaluator.symbolic:
            self._include(as_include(element), context, file)
        elif handler is not None:
            handler(element, context, file)
        elif element.expand is not None:
            view = self._evaluator.context_view(element, context, file)
            self._actions(element.expand(view), context, file)
        elif element.tag in CONTEXT_TAGS:
            ContextActions(self._evaluator).apply(element, context, file, holds)
            self._collector.add_argument(element, context, file)
        elif element.tag not in IGNORED_TAGS:
            self._collector.note_unknown(element, file)

    @property
    def _readers(self) -> Mapping[str, Callable[[Element, LaunchContext, FileInclusion], None]]:
        return {
            **dict.fromkeys(_EVENT_TAGS, self._timer),
            **dict.fromkeys(_NODE_TAGS, self._collector.add_node),
            **dict.fromkeys(GLOBAL_PARAMETER_TAGS, self._collector.add_global_parameters),
            "load_composable_node": self._collector.add_components,
            "executable": self._collector.add_executable,
            "group": self._group,
            "include": self._include,
        }

    def _timer(self, element: Element, context: LaunchContext, file: FileInclusion) -> None:
        try:
            period = float(self._evaluator.text(element, "period", context, file) or 0)
        except ValueError:
            period = 0.0
        due = inf if element.plain_text("event") == "OnShutdown" else self._time + period
        number = self._evaluator.limits.actions
        action_context = self._collector.event_context(element)
        heappush(
            self._timers, _Timer(due, number, element, file, context.is_uncertain, action_context)
        )

    def _group(self, element: Element, context: LaunchContext, file: FileInclusion) -> None:
        context_actions = ContextActions(self._evaluator)
        preserved_configurations = list(
            context_actions.preserved_configurations(element, context, file)
        )
        inner = context.child() if _flag(element, "scoped") else context
        if inner is not context and not _flag(element, "forwarding"):
            inner.clear()
            inner.reset_environment(self._evaluator.environ)
        for item in preserved_configurations:
            inner.set_value(*item)
        self._actions((c for c in element.children if c.tag != "keep"), inner, file)

    def _loop(self, element: Element, context: LaunchContext, file: FileInclusion) -> None:
        """Read the children once for each round."""
        text = self._evaluator.text(element, LOOPS[element.tag], context, file) or ""
        outer_loops, iterations = context.loops, [UNKNOWN_ITERATION]
        with self._evaluator.collect_errors(element, file):
            known_iterations = iterations_of(element.tag, element.plain_text("name"), text)
            if known_iterations is None:
                self._evaluator.note(element, file, UNKNOWN_COUNT)
            iterations = iterations if known_iterations is None else known_iterations
        for values in iterations:
            context.loops = {**outer_loops, **values}
            self._actions(element.children, context, file)
        context.loops = outer_loops

    def _include(self, element: Element, context: LaunchContext, file: FileInclusion) -> None:
        spelled_path = self._evaluator.text(element, "file", context, file)
        arguments = (*element.children_named("arg"), *element.children_named("let"))
        for argument in arguments:
            ContextActions(self._evaluator).set_configuration(argument, context, file)
        spelled_path = bundled_launch_file(spelled_path) if spelled_path else spelled_path
        if spelled_path is None or has_placeholder(spelled_path):
            self._collector.note_not_included(element, spelled_path, file)
            return
        path = self._evaluator.files.locate_source(absolute_path(spelled_path))
        level = self._evaluator.limits.level
        with (
            self._evaluator.collect_errors(element, file),
            self._collector.within_include(element, path, context, file),
        ):
            included = self._file(path, context, file.depth + 1)
            file.includes.append((element, spelled_path, included))
        self._evaluator.limits.level = level


def _flag(element: Element, key: str) -> bool:
    """Return a plain yes or no of an element, which is yes if it is not written."""
    return (element.plain_text(key) or "true").lower() not in _FALSE
