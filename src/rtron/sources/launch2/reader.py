"""ROS 2's launch files in XML and YAML, evaluated: nodes, their namespaces and their remaps.

Sources: docs.ros.org, launch file formats; the docstrings of launch and launch_ros.
Nothing is run, and no Python launch file is looked into: it stands in the tree without nodes.
"""

import os.path
import re
import shlex
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from itertools import pairwise
from pathlib import Path

from rtron.errors import InputError
from rtron.sources.launch.unresolvable import MissingArgumentError, UnresolvableError
from rtron.sources.launch2.element import Element, parse_elements
from rtron.sources.launch2.scope import UNKNOWN, Scope
from rtron.sources.launch2.substitution import Substitution, environment, truth, variable
from rtron.vocabulary import (
    GUARD_NODE,
    Evidence,
    LaunchFile,
    LaunchInclude,
    LaunchNode,
    LaunchTree,
    Remap,
    Unresolved,
)
from rtron.vocabulary.launch import canonical_name

MAX_FILES = 500
MAX_INCLUDED = 32

_NODES = frozenset({"node", "lifecycle_node", "node_container"})
_TIMERS = frozenset({"timer", "ros_timer"})
_PUSHES = frozenset({"push_ros_namespace", "push-ros-namespace"})
_SETTINGS = frozenset({"arg", "let", "set_remap", "reset", *_PUSHES})
_RULE = re.compile(r"(?:(\w+):(?!//))?(.+?):=(.+)")
_SCHEME = re.compile(r"ros(topic|service)://")


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
    reader = _Reader(environ=environ, packages=packages)
    scope = Scope(dict(arguments))
    try:
        root = reader.file(os.path.abspath(path), scope)  # noqa: PTH100 - as launch spells it
    except MissingArgumentError as error:
        help = f"add {error.name}:=…"
        raise InputError(str(error), path=str(path), help=help) from None
    return LaunchTree(root=root, unresolved=tuple(reader.unresolved))


@dataclass(slots=True)
class _Place:
    """A file that is being read, and what was found in it."""

    path: str
    depth: int
    nodes: list[LaunchNode] = field(default_factory=list)
    includes: list[LaunchInclude] = field(default_factory=list)


@dataclass(slots=True, kw_only=True)
class _Reader:
    environ: Mapping[str, str]
    packages: Mapping[str, Path]
    unresolved: list[Unresolved] = field(default_factory=list)
    files: int = 0

    def file(self, path: str, scope: Scope, depth: int = 0) -> LaunchFile:
        self.files += 1
        if self.files > MAX_FILES or depth > MAX_INCLUDED:
            raise InputError(f"includes more than {MAX_FILES} files or itself", path=path)
        if path.endswith(".py"):
            return LaunchFile(path=path)
        place = _Place(path, depth)
        later: list[Element] = []
        for element in parse_elements(path).children:
            self._action(element, scope, place, later)
        for timer in later:
            self._actions(timer.children, scope.inner(), place, [])
        return LaunchFile(path=path, nodes=tuple(place.nodes), includes=tuple(place.includes))

    def _actions(
        self, elements: tuple[Element, ...], scope: Scope, place: _Place, later: list[Element]
    ) -> None:
        for element in elements:
            self._action(element, scope, place, later)

    def _action(self, element: Element, scope: Scope, place: _Place, later: list[Element]) -> None:
        counted = self._counted(element, scope, place)
        if counted is None:
            return
        tag = element.tag
        if tag in _TIMERS:
            # It runs when the groups around it are left: in what is then the outermost scope.
            later.append(element)
        elif tag in _NODES:
            self._node(element, counted, place)
        elif tag == "load_composable_node":
            self._components(element, counted, place)
        elif tag == "group":
            self._group(element, counted, place, later)
        elif tag == "include":
            self._include(element, counted, place)
        elif tag == "executable" and element.attributes.get("name") == GUARD_NODE.strip("/"):
            guard = LaunchNode(name=GUARD_NODE, package="", type="", element=element.place)
            place.nodes.append(guard)
        else:
            self._setting(element, counted, place)

    def _setting(self, element: Element, scope: Scope, place: _Place) -> None:
        """Read an action that changes the scope; all others start no node."""
        if element.tag == "arg":
            self._argument(element, scope, place)
        elif element.tag == "let":
            self._let(element, scope, place)
        elif element.tag in _PUSHES:
            own = self._text(element, "namespace", scope, place)
            scope.namespace = scope.space(UNKNOWN if own is None else own)
        elif element.tag == "set_remap":
            scope.remaps += self._pairs([element], scope, place)
        elif element.tag == "reset":
            scope.configurations.clear()
            scope.unknown.clear()
            scope.namespace, scope.remaps = None, []

    def _argument(self, element: Element, scope: Scope, place: _Place) -> None:
        name = element.attributes.get("name", "")
        if name in scope.configurations or name in scope.unknown:
            return
        if "default" not in element.attributes:
            raise MissingArgumentError(name)
        scope.put(name, self._text(element, "default", scope, place))

    def _let(self, element: Element, scope: Scope, place: _Place) -> None:
        name, value = (self._text(element, key, scope, place) for key in ("name", "value"))
        if name is not None:
            scope.put(name, value)

    def _group(self, element: Element, scope: Scope, place: _Place, later: list[Element]) -> None:
        inner = scope
        if element.attributes.get("scoped", "true").lower() != "false":
            forwards = element.attributes.get("forwarding", "true").lower() != "false"
            inner = scope.inner(forwarding=forwards)
        for kept in element.named("keep"):
            name, value = (self._text(kept, key, scope, place) for key in ("name", "value"))
            if name is not None:
                inner.put(name, value)
        self._actions(element.children, inner, place, later)

    def _include(self, element: Element, scope: Scope, place: _Place) -> None:
        spelled = self._text(element, "file", scope, place)
        for given in element.named("arg"):
            self._let(given, scope, place)
        if spelled is None:
            return
        path = os.path.abspath(spelled)  # noqa: PTH100 - as launch spells it
        with self._noting(element, place):
            file = self.file(path, scope, place.depth + 1)
            included = LaunchInclude(element=element.place, spelled=spelled, file=file)
            place.includes.append(included)

    def _node(self, element: Element, scope: Scope, place: _Place) -> None:
        node = self._named(element, scope, place, "exec")
        place.nodes.append(node)
        if element.tag == "node_container":
            self._components(element, scope, place)

    def _components(self, element: Element, scope: Scope, place: _Place) -> None:
        for component in element.named("composable_node"):
            counted = self._counted(component, scope, place)
            if counted is not None:
                place.nodes.append(self._named(component, counted, place, "plugin"))

    def _named(self, element: Element, scope: Scope, place: _Place, type: str) -> LaunchNode:
        """Return a node, or a component; a name that is not known is a `*`."""
        own = self._text(element, "namespace", scope, place)
        written = "namespace" in element.attributes
        space = scope.space(UNKNOWN if written and own is None else own)
        base = self._text(element, "name", scope, place) or UNKNOWN
        name = f"{space or ''}/{base}" if space != "/" else f"/{base}"
        words = [self._text(element, key, scope, place) or "" for key in ("args", "ros_args")]
        early = [*_rules(words[0], ros=False), *_rules(words[1], ros=True)]
        pairs = [*early, *scope.remaps, *self._pairs(element.named("remap"), scope, place)]
        return LaunchNode(
            name=name,
            package=element.attributes.get("pkg", ""),
            type=element.attributes.get(type, ""),
            args=words[0],
            remaps=tuple(_remaps(pairs, name)),
            element=element.place,
            line=element.line,
            anonymous=UNKNOWN in name,
            conditional=scope.doubtful,
        )

    def _pairs(
        self, elements: "Iterator[Element] | list[Element]", scope: Scope, place: _Place
    ) -> list[tuple[str, str]]:
        found = []
        for element in elements:
            pair = [self._text(element, key, scope, place) for key in ("from", "to")]
            found.append((pair[0] or UNKNOWN, pair[1] or UNKNOWN))
        return found

    def _counted(self, element: Element, scope: Scope, place: _Place) -> Scope | None:
        """Return the scope for an element, None where its condition is false."""
        said: list[bool] = []
        for key, wanted in (("if", True), ("unless", False)):
            text = self._text(element, key, scope, place)
            with self._noting(element, place):
                said += [] if text is None else [truth(text) is wanted]
        conditions = [key for key in ("if", "unless") if key in element.attributes]
        if False in said:
            return None
        known = len(said) == len(conditions)
        return scope if known or element.tag in _SETTINGS else replace(scope, doubtful=True)

    def _text(self, element: Element, key: str, scope: Scope, place: _Place) -> str | None:
        """Return an attribute's value; None where it is not written, or, noted, has none here."""
        written = element.attributes.get(key)
        if written is None:
            return None
        with self._noting(element, place):
            return self._substitution(scope, place).replace(written)
        return None

    def _substitution(self, scope: Scope, place: _Place) -> Substitution:
        folder = os.path.dirname(place.path)  # noqa: PTH120 - a string in a string out
        return Substitution(
            {
                "var": variable(scope.configurations, scope.unknown),
                "env": environment(self.environ),
                "dirname": lambda _: folder,
                "filename": lambda _: place.path,
                "anon": lambda words: f"{words[0]}_{UNKNOWN}",
                "find-pkg-share": self._share,
                "find-pkg-prefix": self._prefix,
            }
        )

    def _share(self, words: list[str]) -> str:
        name = "".join(words[:1])
        if name in self.packages:
            return str(self.packages[name])
        for prefix in filter(None, self.environ.get("AMENT_PREFIX_PATH", "").split(":")):
            if (Path(prefix) / "share" / name).is_dir():
                return str(Path(prefix) / "share" / name)
        raise UnresolvableError(f"package '{name}' is not here")

    def _prefix(self, words: list[str]) -> str:
        return str(Path(self._share(words)).parents[1])

    @contextmanager
    def _noting(self, element: Element, place: _Place) -> Iterator[None]:
        """Note what has no value here, or a file that cannot be read; go on with the rest."""
        try:
            yield
        except (UnresolvableError, InputError) as error:
            own = Evidence(file=place.path, line=element.line)
            what = f"{element.tag} {element.attributes.get('file') or ''}".strip()
            self.unresolved.append(Unresolved(what=what, why=str(error), evidence=(own,)))
        except MissingArgumentError as error:
            if place.depth == 0 and element.tag != "include":
                raise
            own = Evidence(file=place.path, line=element.line)
            self.unresolved.append(Unresolved(what=element.tag, why=str(error), evidence=(own,)))
        except (ValueError, LookupError) as error:
            raise InputError(str(error), path=place.path, line=element.line) from None


def _rules(text: str, *, ros: bool) -> Iterator[tuple[str, str]]:
    """Yield the remap rules in a node's arguments, which count before all others."""
    try:
        words = shlex.split(text)
    except ValueError:
        words = text.split()
    for word, following in pairwise([*words, ""]):
        ros = word == "--ros-args" or (ros and word != "--")
        rule = _RULE.fullmatch(following) if ros and word in {"-r", "--remap"} else None
        if rule and not rule[2].startswith("__"):
            yield f"{rule[1]}:{rule[2]}" if rule[1] else rule[2], rule[3]


def _remaps(pairs: list[tuple[str, str]], node: str) -> Iterator[Remap]:
    """Yield the rules that concern a node; one may begin with a node's name."""
    for written, target in pairs:
        rule = _RULE.fullmatch(f"{written}:={target}")
        if rule and (rule[1] is None or rule[1] == node.rpartition("/")[2]):
            yield Remap(
                written=written,
                written_target=target,
                declared=_resolved(rule[2], node),
                target=_resolved(target, node),
            )


def _resolved(name: str, node: str) -> str:
    """Return a name as rcl expands it at a node (design.ros2.org: topic and service names)."""
    space, _, base = node.rpartition("/")
    name = _SCHEME.sub("", name)
    for hole, value in (("{node}", base), ("{namespace}", space), ("{ns}", space)):
        name = name.replace(hole, value)
    if name.startswith("~"):
        return canonical_name(node + name[1:])
    return canonical_name(name if name.startswith("/") else f"{space}/{name}")
