"""ROS 2's launch files, evaluated: nodes, their namespaces and their remaps.

Sources: docs.ros.org, launch file formats; the docstrings of launch and launch_ros, and what both
do when they run. Nothing is run. `read_launch2` is for the guarded launch: it looks into no Python
launch file, which stands in the tree without nodes. `app.read_app_launch` looks into all.
"""

import os.path
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field
from heapq import heappop, heappush
from math import inf
from pathlib import Path

from rtron.errors import InputError
from rtron.sources.launch.common.errors import MissingArgumentError
from rtron.sources.launch.ros2.action_context import Setting
from rtron.sources.launch.ros2.bundled_files import known_launch
from rtron.sources.launch.ros2.choices import Choices
from rtron.sources.launch.ros2.context_actions import HARMLESS, SETTINGS, Settings
from rtron.sources.launch.ros2.evaluator import Evaluator
from rtron.sources.launch.ros2.gazebo_actions import GAZEBO_ACTIONS, inclusion
from rtron.sources.launch.ros2.inclusion import Place
from rtron.sources.launch.ros2.launch_context import Scope
from rtron.sources.launch.ros2.limits import MAX_INCLUDED
from rtron.sources.launch.ros2.node_collector import GuardedNodes
from rtron.sources.launch.ros2.start_collector import SHARED, Starts
from rtron.sources.launch.ros2.substitutions.loops import LOOPS, NOT_KNOWN, OPEN_ROUND, rounds_of
from rtron.sources.launch.ros2.substitutions.template import has_hole
from rtron.sources.launch.ros2.xml_yaml.element import Element, parse_elements
from rtron.vocabulary import LaunchTree

_NODES = frozenset({"node", "lifecycle_node", "node_container"})
_TIMERS = frozenset({"timer", "ros_timer", "event_handler"})
_STARTING = (
    _NODES
    | _TIMERS
    | GAZEBO_ACTIONS
    | {"load_composable_node", "group", "include", "composable_node", "function", "executable"}
)
_NO = frozenset({"false", "no", "off"})


def read_launch2(
    path: Path,
    arguments: Mapping[str, str],
    environ: Mapping[str, str],
    packages: Mapping[str, Path],
) -> LaunchTree:
    """Return what a launch file starts; raise InputError where launch would refuse it.

    `arguments` are those of the command line, `packages` where packages lie. What cannot be
    evaluated is noted: a condition then counts as true, a name or namespace has a `*`.
    """
    choices = Choices(arguments=arguments, environ=environ)
    evaluator = Evaluator(environ=environ, packages=packages, choices=choices)
    scope = Scope(dict(arguments), dict(environ))
    try:
        place = Reader(evaluator, GuardedNodes(evaluator)).root(absolute(path), scope)
    except MissingArgumentError as error:
        help = f"add {error.name}:=…"
        raise InputError(str(error), path=str(path), help=help) from None
    return LaunchTree(
        root=place.file(), unresolved=tuple(evaluator.unresolved), choices=choices.all()
    )


def absolute(path: Path | str) -> str:
    """Return a path as launch spells it, no links followed."""
    return os.path.abspath(path)  # noqa: PTH100 - a string


@dataclass(frozen=True, slots=True, order=True)
class _Timer:
    """Actions that run later, `due` seconds after the start; `number` counts the timers."""

    due: float
    number: int
    element: Element = field(compare=False)
    place: Place = field(compare=False)
    doubtful: bool = field(compare=False)
    setting: Setting = field(compare=False)


@dataclass(slots=True)
class Reader:
    """Walks through launch files; `nodes` takes what they start."""

    _evaluator: Evaluator
    _nodes: GuardedNodes | Starts
    _timers: list[_Timer] = field(default_factory=list)
    _parsed: dict[str, Element] = field(default_factory=dict)
    _now: float = 0.0

    def root(self, path: str, scope: Scope) -> Place:
        """Read a launch file and all that it includes."""
        place = self._file(path, scope, 0)
        while self._timers:
            # It runs when the groups and files around it are left: in what is then the one scope.
            timer = heappop(self._timers)
            self._now, scope.doubtful = timer.due, timer.doubtful
            with self._nodes.later(timer.setting):
                self._actions(timer.element.children, scope, timer.place)
        return place

    def _file(self, path: str, scope: Scope, depth: int) -> Place:
        if depth > MAX_INCLUDED:
            raise InputError(f"{MAX_INCLUDED} files include each other", path=path)
        place = Place(path, depth)
        self._evaluator.bounds.file(path)
        root = self._root(path)
        if root is not None:
            self._evaluator.bounds.size(path, Path(path).stat().st_size)
            self._actions(root.children, scope, place)
        return place

    def _root(self, path: str) -> Element | None:
        """Return a file's actions; a Python file is read anew each time, as it is run."""
        if path.endswith(".py"):
            return self._nodes.python(path)
        if path not in self._parsed:
            self._parsed[path] = parse_elements(path)
        return self._parsed[path]

    def _actions(self, elements: Iterable[Element], scope: Scope, place: Place) -> None:
        self._evaluator.bounds.deeper(place.path)
        for element in elements:
            self._counted(element, scope, place)
        self._evaluator.bounds.level -= 1

    def _counted(self, element: Element, scope: Scope, place: Place) -> None:
        """Read an action if its condition lets it run; another value of it may be refused later."""
        self._evaluator.bounds.action(place.path, scope)
        said, why = self._evaluator.condition(element, scope, place)
        setting, starting = element.tag in SETTINGS, element.tag in _STARTING
        if setting or (starting and said is False):
            self._evaluator.choices.decide(why)
        if said is False:
            return
        before, doubtful = scope.mark(), scope.doubtful
        scope.doubtful = doubtful or (said is None and not setting)
        with self._nodes.under(element, scope, place, said):
            self._action(element, scope, place, said)
        scope.doubtful = doubtful
        if starting and scope.depend(why, before):
            self._evaluator.choices.decide(why)

    def _action(
        self,
        element: Element,
        scope: Scope,
        place: Place,
        said: bool | None,  # noqa: FBT001 - what its condition says
    ) -> None:
        read = self._readers.get(element.tag)
        if element.tag in LOOPS and self._evaluator.symbolic:
            # A guarded launch has none: its nodes could not have remaps of their own.
            self._loop(element, scope, place)
        elif element.tag in GAZEBO_ACTIONS and self._evaluator.symbolic:
            self._include(inclusion(element), scope, place)
        elif read is not None:
            read(element, scope, place)
        elif element.run is not None:
            view = self._evaluator.view(element, scope, place)
            self._actions(element.run(view), scope, place)
        elif element.tag in SETTINGS:
            Settings(self._evaluator).apply(element, scope, place, said)
            self._nodes.declared(element, scope, place)
        elif element.tag not in HARMLESS:
            self._nodes.unknown(element, place)

    @property
    def _readers(self) -> Mapping[str, Callable[[Element, Scope, Place], None]]:
        return {
            **dict.fromkeys(_TIMERS, self._timer),
            **dict.fromkeys(_NODES, self._nodes.node),
            **dict.fromkeys(SHARED, self._nodes.share),
            "load_composable_node": self._nodes.components,
            "executable": self._nodes.executable,
            "group": self._group,
            "include": self._include,
        }

    def _timer(self, element: Element, scope: Scope, place: Place) -> None:
        try:
            period = float(self._evaluator.text(element, "period", scope, place) or 0)
        except ValueError:
            period = 0.0
        due = inf if element.plain("event") == "OnShutdown" else self._now + period
        number, setting = self._evaluator.bounds.actions, self._nodes.setting(element)
        heappush(self._timers, _Timer(due, number, element, place, scope.doubtful, setting))

    def _group(self, element: Element, scope: Scope, place: Place) -> None:
        settings = Settings(self._evaluator)
        kept = list(settings.kept(element, scope, place))
        inner = scope.inner() if _says(element, "scoped") else scope
        if inner is not scope and not _says(element, "forwarding"):
            inner.clear()
            inner.renew(self._evaluator.environ)
        for item in kept:
            inner.put(*item)
        self._actions((c for c in element.children if c.tag != "keep"), inner, place)

    def _loop(self, element: Element, scope: Scope, place: Place) -> None:
        """Read the children once for each round."""
        text = self._evaluator.text(element, LOOPS[element.tag], scope, place) or ""
        around, rounds = scope.loops, [OPEN_ROUND]
        with self._evaluator.noting(element, place):
            found = rounds_of(element.tag, element.plain("name"), text)
            if found is None:
                self._evaluator.note(element, place, NOT_KNOWN)
            rounds = rounds if found is None else found
        for values in rounds:
            scope.loops = {**around, **values}
            self._actions(element.children, scope, place)
        scope.loops = around

    def _include(self, element: Element, scope: Scope, place: Place) -> None:
        spelled = self._evaluator.text(element, "file", scope, place)
        given = (*element.named("arg"), *element.named("let"))
        for argument in given:
            Settings(self._evaluator).let(argument, scope, place)
        spelled = known_launch(spelled) if spelled else spelled
        if spelled is None or has_hole(spelled):
            self._nodes.not_included(element, spelled, place)
            return
        path = self._evaluator.files.installed(absolute(spelled))
        level = self._evaluator.bounds.level
        with (
            self._evaluator.noting(element, place),
            self._nodes.within(element, path, scope, place),
        ):
            included = self._file(path, scope, place.depth + 1)
            place.includes.append((element, spelled, included))
        self._evaluator.bounds.level = level


def _says(element: Element, key: str) -> bool:
    """Return a plain yes or no of an element, which is yes if it is not written."""
    return (element.plain(key) or "true").lower() not in _NO
