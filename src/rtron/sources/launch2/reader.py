"""ROS 2's launch files in XML and YAML, evaluated: nodes, their namespaces and their remaps.

Sources: docs.ros.org, launch file formats; the docstrings of launch and launch_ros, and what both
do when they run. Nothing is run, and no Python launch file is looked into: it stands in the tree
without nodes.
"""

import os.path
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from heapq import heappop, heappush
from pathlib import Path

from rtron.errors import InputError
from rtron.sources.launch.unresolvable import MissingArgumentError
from rtron.sources.launch2.bounds import MAX_INCLUDED
from rtron.sources.launch2.choices import Choices
from rtron.sources.launch2.element import Element, parse_elements
from rtron.sources.launch2.evaluator import Evaluator
from rtron.sources.launch2.place import Place
from rtron.sources.launch2.scope import NAMESPACE, Scope, Source
from rtron.sources.launch2.settings import HARMLESS, PUSHES, SETTINGS
from rtron.vocabulary import GUARD_NODE, LaunchFile, LaunchNode, LaunchTree
from rtron.vocabulary.remap_rules import UNKNOWN, Rule, remaps_at, rules_in

_NODES = frozenset({"node", "lifecycle_node", "node_container"})
_TIMERS = frozenset({"timer", "ros_timer"})
_STARTING = _NODES | _TIMERS | {"load_composable_node", "group", "include", "composable_node"}
_NO = frozenset({"false", "no", "off"})
_NOT_REACHED = "is no `node`: what it starts gets no remaps"


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
        root = _Reader(evaluator).root(os.path.abspath(path), scope)  # noqa: PTH100 - as launch spells it
    except MissingArgumentError as error:
        help = f"add {error.name}:=…"
        raise InputError(str(error), path=str(path), help=help) from None
    return LaunchTree(root=root, unresolved=tuple(evaluator.unresolved), choices=choices.all())


@dataclass(frozen=True, slots=True, order=True)
class _Timer:
    """Actions that run later, `due` seconds after the start; `number` counts the timers."""

    due: float
    number: int
    element: Element = field(compare=False)
    place: Place = field(compare=False)
    doubtful: bool = field(compare=False)


@dataclass(slots=True)
class _Reader:
    _evaluator: Evaluator
    _timers: list[_Timer] = field(default_factory=list)
    _parsed: dict[str, Element] = field(default_factory=dict)
    _now: float = 0.0

    def root(self, path: str, scope: Scope) -> LaunchFile:
        place = self._file(path, scope, 0)
        while self._timers:
            # It runs when the groups and files around it are left: in what is then the one scope.
            timer = heappop(self._timers)
            self._now, scope.doubtful = timer.due, timer.doubtful
            self._actions(timer.element.children, scope, timer.place)
        return place.file()

    def _file(self, path: str, scope: Scope, depth: int) -> Place:
        if depth > MAX_INCLUDED:
            raise InputError(f"{MAX_INCLUDED} files include each other", path=path)
        place = Place(path, depth)
        self._evaluator.bounds.file(path)
        if not path.endswith(".py"):
            if path not in self._parsed:
                self._parsed[path] = parse_elements(path)
            self._evaluator.bounds.size(path, Path(path).stat().st_size)
            self._actions(self._parsed[path].children, scope, place)
        return place

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
        self._action(element, scope, place)
        scope.doubtful = doubtful
        if starting and scope.depend(why, before):
            self._evaluator.choices.decide(why)

    def _action(self, element: Element, scope: Scope, place: Place) -> None:
        tag = element.tag
        if tag in _TIMERS:
            self._timer(element, scope, place)
        elif tag in _NODES:
            self._node(element, scope, place)
        elif tag == "load_composable_node":
            self._components(element, scope, place)
        elif tag == "group":
            self._group(element, scope, place)
        elif tag == "include":
            self._include(element, scope, place)
        elif tag == "executable":
            self._executable(element, place)
        elif tag in SETTINGS:
            self._setting(element, scope, place)
        elif tag not in HARMLESS:
            self._evaluator.note(element, place, "is not known here; what it starts gets no remaps")

    def _executable(self, element: Element, place: Place) -> None:
        """Note a process that is no `<node>`: only at run time can a node in it be seen."""
        if element.attributes.get("name") == GUARD_NODE.strip("/"):
            guard = LaunchNode(name=GUARD_NODE, package="", type="", element=element.place)
            place.nodes.append(guard)
        else:
            self._evaluator.note(element, place, _NOT_REACHED)

    def _setting(self, element: Element, scope: Scope, place: Place) -> None:
        """Read an action that changes the scope."""
        tag = element.tag
        if tag == "arg":
            self._argument(element, scope, place)
        elif tag == "let":
            self._let(element, scope, place)
        elif tag in PUSHES:
            own = self._evaluator.text(element, "namespace", scope, place)
            space, source = scope.space(UNKNOWN if own is None else own), Source(NAMESPACE)
            scope.put(source, None if space == UNKNOWN else space, scope.behind(source))
        elif tag == "set_remap":
            scope.share(self._evaluator.pairs([element], scope, place))
        elif tag == "reset":
            kept = list(self._kept(element, scope, place))
            scope.clear()
            for item in kept:
                scope.put(*item)
        elif tag == "reset_env":
            scope.renew(self._evaluator.environ)
        else:
            self._variable(element, scope, place)

    def _variable(self, element: Element, scope: Scope, place: Place) -> None:
        name = self._evaluator.text(element, "name", scope, place)
        if name is None:
            return
        value = self._evaluator.value(element, "value", scope, place)
        touched = frozenset(self._evaluator.touched)
        variable = Source(name, environment=True)
        if element.tag == "unset_env":
            scope.put(variable, None)
            scope.unknown.discard(variable)
        elif element.tag == "set_env":
            scope.put(variable, value, touched)
        else:
            scope.put(variable, None, touched | scope.behind(variable))

    def _argument(self, element: Element, scope: Scope, place: Place) -> None:
        source = Source(element.attributes.get("name", ""))
        if source.name in scope.configurations or source in scope.unknown:
            return
        if "default" not in element.attributes:
            raise MissingArgumentError(source.name)
        value = self._evaluator.value(element, "default", scope, place)
        self._evaluator.choices.default(source.name, value)
        scope.put(source, value, {source, *self._evaluator.touched})

    def _let(self, element: Element, scope: Scope, place: Place) -> None:
        for item in self._evaluator.given([element], scope, place):
            scope.put(*item)

    def _kept(
        self, element: Element, scope: Scope, place: Place
    ) -> Iterator[tuple[Source, str | None, frozenset[Source]]]:
        return self._evaluator.given(element.named("keep"), scope, place)

    def _timer(self, element: Element, scope: Scope, place: Place) -> None:
        try:
            period = float(self._evaluator.text(element, "period", scope, place) or 0)
        except ValueError:
            period = 0.0
        due, number = self._now + period, self._evaluator.bounds.actions
        heappush(self._timers, _Timer(due, number, element, place, scope.doubtful))

    def _group(self, element: Element, scope: Scope, place: Place) -> None:
        kept = list(self._kept(element, scope, place))
        inner = scope.inner() if _says(element, "scoped") else scope
        if inner is not scope and not _says(element, "forwarding"):
            inner.clear()
            inner.renew(self._evaluator.environ)
        for item in kept:
            inner.put(*item)
        self._actions((c for c in element.children if c.tag != "keep"), inner, place)

    def _include(self, element: Element, scope: Scope, place: Place) -> None:
        spelled = self._evaluator.text(element, "file", scope, place)
        for given in (*element.named("arg"), *element.named("let")):
            self._let(given, scope, place)
        if spelled is None:
            return
        path = os.path.abspath(spelled)  # noqa: PTH100 - as launch spells it
        level = self._evaluator.bounds.level
        with self._evaluator.noting(element, place):
            included = self._file(path, scope, place.depth + 1)
            place.includes.append((element, spelled, included))
        self._evaluator.bounds.level = level

    def _node(self, element: Element, scope: Scope, place: Place) -> None:
        place.nodes.append(self._named(element, scope, place, "exec"))
        if element.tag == "node_container":
            self._components(element, scope, place)

    def _components(self, element: Element, scope: Scope, place: Place) -> None:
        for component in element.named("composable_node"):
            said, why = self._evaluator.condition(component, scope, place)
            if said is False:
                self._evaluator.choices.decide(why)
            else:
                doubtful, scope.doubtful = scope.doubtful, scope.doubtful or said is None
                place.nodes.append(self._named(component, scope, place, "plugin"))
                scope.doubtful = doubtful

    def _named(self, element: Element, scope: Scope, place: Place, type: str) -> LaunchNode:
        """Return a node, or a component; a name that is not known is a `*`."""
        self._evaluator.bounds.node(place.path)
        own = self._evaluator.text(element, "namespace", scope, place)
        written = "namespace" in element.attributes
        space = scope.space(UNKNOWN if written and own is None else own)
        base = self._evaluator.text(element, "name", scope, place) or UNKNOWN
        name = f"{space or ''}/{base}" if space != "/" else f"/{base}"
        self._evaluator.choices.decide(scope.behind(Source(NAMESPACE)))
        args, early = self._early(element, scope, place)
        shared = tuple(remaps_at([*early, *(scope.remaps or ())], name))
        rules = remaps_at(self._evaluator.pairs(element.named("remap"), scope, place), name)
        return LaunchNode(
            name=name,
            package=element.attributes.get("pkg", ""),
            type=element.attributes.get(type, ""),
            args=args,
            remaps=(*shared, *rules),
            element=element.place,
            line=element.line,
            anonymous=UNKNOWN in name,
            conditional=scope.doubtful,
            shared=len(shared),
        )

    def _early(self, element: Element, scope: Scope, place: Place) -> tuple[str, list[Rule]]:
        """Return a node's arguments, and the rules in them, which count before all others."""
        args = self._evaluator.value(element, "args", scope, place) or ""
        touched = set(self._evaluator.touched)
        ros = self._evaluator.value(element, "ros_args", scope, place) or ""
        rules = [*rules_in(args, ros=False), *rules_in(ros, ros=True)]
        self._evaluator.choices.decide(touched | self._evaluator.touched if rules else ())
        return args, rules


def _says(element: Element, key: str) -> bool:
    """Return a plain yes or no of an element, which is yes if it is not written."""
    return element.attributes.get(key, "true").lower() not in _NO
