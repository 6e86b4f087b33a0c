"""ROS 2's launch files, evaluated: nodes, their namespaces and their remaps.

Sources: docs.ros.org, launch file formats; the docstrings of launch and launch_ros, and what both
do when they run. Nothing is run. `read_ros2_launch` is for the guarded launch: it looks into no
Python launch file, which is in the tree without nodes. `app.read_app_launch` looks into all.
"""

import os.path
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field, replace
from heapq import heappop, heappush
from math import inf
from pathlib import Path

from rtron.errors import InputError
from rtron.sources.launch.common.errors import MissingArgumentError
from rtron.sources.launch.ros2.bundled_launches import (
    GAZEBO_ACTIONS,
    as_include,
    bundled_launch_file,
)
from rtron.sources.launch.ros2.choices import (
    LaunchChoices,
    evaluate_condition,
    note_unknown_condition,
)
from rtron.sources.launch.ros2.context_actions import (
    CONTEXT_TAGS,
    IGNORED_TAGS,
    ContextActions,
    note_undeclared,
)
from rtron.sources.launch.ros2.context_view import ContextView
from rtron.sources.launch.ros2.element_site import ElementSite, FileInclusion
from rtron.sources.launch.ros2.evaluator import LaunchEvaluator
from rtron.sources.launch.ros2.launch_context import LaunchContext
from rtron.sources.launch.ros2.limits import MAX_INCLUDE_DEPTH
from rtron.sources.launch.ros2.node_collector import LaunchCollector, LaunchNodeCollector
from rtron.sources.launch.ros2.start_collector import GLOBAL_PARAMETER_TAGS
from rtron.sources.launch.ros2.substitutions.functions import (
    LOOPS,
    UNKNOWN_COUNT,
    UNKNOWN_ITERATION,
    iterations_of,
)
from rtron.sources.launch.ros2.substitutions.template import has_placeholder
from rtron.sources.launch.ros2.xml_yaml import Element, parse_elements
from rtron.vocabulary import LaunchTree, WiringFact, WiringFactKind
from rtron.vocabulary.remap_rules import UNKNOWN_NAME

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
    collector = LaunchNodeCollector(evaluator)
    try:
        file = LaunchReader(evaluator, collector).root(path)
    except MissingArgumentError as error:
        help = f"add {error.name}:=…"
        raise InputError(str(error), path=str(path), help=help) from None
    unresolved = tuple(evaluator.unresolved)
    return LaunchTree(
        root=file.launch_file(),
        unresolved=unresolved,
        inputs=choices.all(),
        declared=frozenset(choices.declared),
    )


def absolute_path(path: Path | str) -> str:
    """Return a path as launch spells it, no links followed."""
    return os.path.abspath(path)  # noqa: PTH100 - a string


@dataclass(frozen=True, slots=True, order=True)
class _Timer:
    """Actions that run later, `due` seconds after the start; `number` counts the timers."""

    due: float
    number: int
    site: ElementSite = field(compare=False)
    is_uncertain: bool = field(compare=False)


@dataclass(slots=True)
class LaunchReader:
    """Walks through launch files; `_collector` takes what they start."""

    _evaluator: LaunchEvaluator
    _collector: LaunchCollector
    _timers: list[_Timer] = field(default_factory=list)
    _elements_by_path: dict[str, Element] = field(default_factory=dict)
    _time: float = 0.0

    def root(self, path: Path) -> FileInclusion:
        """Read a launch file and all that it includes."""
        choices = self._evaluator.choices
        context = LaunchContext(dict(choices.arguments), dict(choices.environ))
        file = self._file(absolute_path(path), context, 0)
        while self._timers:
            # It runs when the groups and files around it are left: in what is then the one scope.
            timer = heappop(self._timers)
            self._time, context.is_uncertain = timer.due, timer.is_uncertain
            self._actions(timer.site.element.children, context, timer.site.file)
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
        else:
            self._evaluator.choices.declared.add(UNKNOWN_NAME)
        return file

    def _root(self, path: str) -> Element | None:
        """Return a file's actions; a Python file is read anew each time, as it is run."""
        if path.endswith(".py"):
            return self._collector.read_python(path)
        if path not in self._elements_by_path:
            self._elements_by_path[path] = self._collector.accept(parse_elements(path), path)
        return self._elements_by_path[path]

    def _actions(
        self, elements: Iterable[Element], context: LaunchContext, file: FileInclusion
    ) -> None:
        self._evaluator.limits.enter_level(file.path)
        for element in elements:
            self._evaluator.limits.count_action(file.path, context)
            self._run_if(ElementSite(element, context, file), self._action)
        self._evaluator.limits.level -= 1

    def _run_if(self, site: ElementSite, run: Callable[[ElementSite], None]) -> None:
        """Run an action if its condition lets it; another value of it may be refused later.

        What it sets under a condition that is not known is not known afterwards.
        """
        context = site.context
        holds, dependencies = evaluate_condition(self._evaluator, site)
        changes_context, starts = site.tag in CONTEXT_TAGS, site.tag in _STARTING_TAGS
        if changes_context or (starts and holds is False):
            self._evaluator.choices.decide(dependencies)
        if holds is False:
            self._evaluator.choices.skip(site.element)
            return
        before, outer_uncertain = context.change_mark(), context.is_uncertain
        is_undecided = holds is None and self._evaluator.symbolic
        previous = context.child() if is_undecided else context
        context.is_uncertain = outer_uncertain or (holds is None and not changes_context)
        if is_undecided:
            note_unknown_condition(self._evaluator, site)
        run(site)
        context.is_uncertain = outer_uncertain
        if is_undecided:
            context.forget_changes(previous, new=site.tag != "include")
        if starts and context.add_dependencies(dependencies, before):
            self._evaluator.choices.decide(dependencies)

    def _action(self, site: ElementSite) -> None:
        reader = self._readers.get(site.tag)
        if site.tag in LOOPS and self._evaluator.symbolic:
            # A guarded launch has none: its nodes could not have remaps of their own.
            self._loop(site)
        elif site.tag in GAZEBO_ACTIONS and self._evaluator.symbolic:
            self._include(site.at(as_include(site.element)))
        elif reader is not None:
            reader(site)
        elif site.element.expand is not None:
            self._function(site, site.element.expand)
        elif site.tag in CONTEXT_TAGS:
            ContextActions(self._evaluator).apply(site)
            self._collector.add_argument(site)
        elif site.tag not in IGNORED_TAGS:
            self._evaluator.choices.declared.add(UNKNOWN_NAME)
            self._collector.note_unknown(site)

    @property
    def _readers(self) -> Mapping[str, Callable[[ElementSite], None]]:
        return {
            **dict.fromkeys(_EVENT_TAGS, self._timer),
            **dict.fromkeys(_NODE_TAGS, self._node),
            **dict.fromkeys(GLOBAL_PARAMETER_TAGS, self._collector.add_global_parameters),
            "load_composable_node": self._load,
            "executable": self._collector.add_executable,
            "group": self._group,
            "include": self._include,
            "lifecycle_transition": self._note_transition,
        }

    def _note_transition(self, site: ElementSite, key: str = "node") -> None:
        """Note that a launch file changes the state of the node that an attribute names."""
        kind, name = WiringFactKind.TRANSITION, self._evaluator.value(site, key) or ""
        known = "" if has_placeholder(name) else name.rpartition("/")[2]
        fact = WiringFact(kind=kind, subject=site.file.path, value=known)
        self._evaluator.wiring.append(replace(fact, evidence=(site.location,)))

    def _node(self, site: ElementSite) -> None:
        name = self._collector.add_node(site)
        if site.has("autostart"):
            self._note_transition(site, "name")
        if site.tag == "node_container":
            self._components(site, name)

    def _load(self, site: ElementSite) -> None:
        self._components(site, self._collector.container_name(site))

    def _components(self, site: ElementSite, container: str) -> None:
        for component in site.children("composable_node"):
            self._run_if(component, lambda site: self._collector.add_component(site, container))

    def _function(
        self, site: ElementSite, expand: Callable[[ContextView], Iterable[Element]]
    ) -> None:
        """Run what a function makes; what that sets depends on all that the function asks for."""
        before = site.context.change_mark()
        self._evaluator.dependencies = set()
        elements = expand(self._evaluator.context_view(site))
        dependencies = frozenset(self._evaluator.dependencies)
        self._actions(elements, site.context, site.file)
        site.context.add_dependencies(dependencies, before)

    def _timer(self, site: ElementSite) -> None:
        try:
            period = float(self._evaluator.text(site, "period") or 0)
        except ValueError:
            period = 0.0
        due = inf if site.plain_text("event") == "OnShutdown" else self._time + period
        number = self._evaluator.limits.actions
        heappush(self._timers, _Timer(due, number, site, site.context.is_uncertain))

    def _group(self, site: ElementSite) -> None:
        preserved = ContextActions(self._evaluator).preserved_configurations(site)
        inner = site.context.child() if _flag(site, "scoped") else site.context
        if inner is not site.context and not _flag(site, "forwarding"):
            inner.clear()
            inner.reset_environment(self._evaluator.environ)
        for setting in preserved:
            inner.set_value(*setting)
        actions = (child for child in site.element.children if child.tag != "keep")
        self._actions(actions, inner, site.file)

    def _loop(self, site: ElementSite) -> None:
        """Read the children once for each round."""
        context, tag = site.context, site.tag
        text = self._evaluator.text(site, LOOPS[tag]) or ""
        outer_loops, iterations = context.loops, None
        with self._evaluator.collect_errors(site):
            iterations = iterations_of(tag, site.plain_text("name"), text)
            if iterations is None:
                self._evaluator.note(site, UNKNOWN_COUNT)
        for values in [UNKNOWN_ITERATION] if iterations is None else iterations:
            context.loops = {**outer_loops, **values}
            self._actions(site.element.children, context, site.file)
        context.loops = outer_loops

    def _include(self, site: ElementSite) -> None:
        path, before = self._evaluator.text(site, "file"), dict(site.context.origins)
        for argument in site.children("arg", "let"):
            ContextActions(self._evaluator).give_argument(argument)
        path = path and bundled_launch_file(path)
        if path is None or has_placeholder(path):
            self._evaluator.choices.skip(site.element)
            self._collector.note_not_included(site, path)
            return
        source = self._evaluator.files.locate_source(absolute_path(path))
        level, choices = self._evaluator.limits.level, self._evaluator.choices
        included, outer, choices.declared = None, choices.declared, set[str]()
        with self._evaluator.collect_errors(site):
            included = self._file(source, site.context, site.file.depth + 1)
            site.file.includes.append((site.element, path, included))
            site.context.leave_file(source, before)
            note_undeclared(self._evaluator, site, included)
        choices.declared |= outer if included else {*outer, UNKNOWN_NAME}
        self._evaluator.limits.level = level


def _flag(site: ElementSite, key: str) -> bool:
    """Return a plain yes or no of an element, which is yes if it is not written."""
    return (site.plain_text(key) or "true").lower() not in _FALSE
