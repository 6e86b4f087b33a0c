"""The nodes of a launch file as the guarded launch needs them: each with its element's place."""

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass

from rtron.sources.launch.ros2.action_context import Setting
from rtron.sources.launch.ros2.evaluator import Evaluator
from rtron.sources.launch.ros2.inclusion import Place
from rtron.sources.launch.ros2.launch_context import NAMESPACE, Scope, Source
from rtron.sources.launch.ros2.xml_yaml.element import Element
from rtron.vocabulary import GUARD_NODE, LaunchNode
from rtron.vocabulary.remap_rules import UNKNOWN, Rule, remaps_at, rules_in

_NOT_REACHED = "is no `node`: what it starts gets no remaps"


@dataclass(slots=True)
class GuardedNodes:
    """Takes what a launch starts into the tree of its files; Python files are not looked into."""

    _evaluator: Evaluator

    def python(self, path: str) -> None:
        """Leave a Python launch file as it is."""

    def node(self, element: Element, scope: Scope, place: Place) -> None:
        """Take a node, and what is to be loaded into it."""
        place.nodes.append(self._named(element, scope, place, "exec"))
        if element.tag == "node_container":
            self.components(element, scope, place)

    def components(self, element: Element, scope: Scope, place: Place) -> None:
        """Take the components that an action loads."""
        for component in element.named("composable_node"):
            said, why = self._evaluator.condition(component, scope, place)
            if said is False:
                self._evaluator.choices.decide(why)
            else:
                doubtful, scope.doubtful = scope.doubtful, scope.doubtful or said is None
                place.nodes.append(self._named(component, scope, place, "plugin"))
                scope.doubtful = doubtful

    def executable(self, element: Element, _: Scope, place: Place) -> None:
        """Note a process that is no `<node>`: only at run time can a node in it be seen."""
        if element.attributes.get("name") == GUARD_NODE.strip("/"):
            guard = LaunchNode(name=GUARD_NODE, package="", type="", element=element.place)
            place.nodes.append(guard)
        else:
            self._evaluator.note(element, place, _NOT_REACHED)

    def unknown(self, element: Element, place: Place) -> None:
        """Note an action of a kind that is not known."""
        self._evaluator.note(element, place, "is not known here; what it starts gets no remaps")

    def not_included(self, element: Element, spelled: str | None, place: Place) -> None:
        """Leave an inclusion whose file has no value here: that is noted already."""

    def share(self, element: Element, scope: Scope, place: Place) -> None:
        """Leave parameters, which change no name."""

    def declared(self, element: Element, scope: Scope, place: Place) -> None:
        """Leave arguments to the choices."""

    def setting(self, _: Element) -> Setting:
        """Return what surrounds an action, which is not asked for here."""
        return Setting()

    @contextmanager
    def later(self, _: Setting) -> Iterator[None]:
        """Read what runs later."""
        yield

    @contextmanager
    def under(
        self,
        _: Element,
        __: Scope,
        ___: Place,
        ____: bool | None,  # noqa: FBT001
    ) -> Iterator[None]:
        """Read an action under its condition."""
        yield

    @contextmanager
    def within(self, _: Element, __: str, ___: Scope, ____: Place) -> Iterator[None]:
        """Read an included file."""
        yield

    def _named(self, element: Element, scope: Scope, place: Place, type: str) -> LaunchNode:
        """Return a node, or a component; a name that is not known is a `*`."""
        self._evaluator.bounds.node(place.path)
        own = self._evaluator.text(element, "namespace", scope, place)
        written = "namespace" in element.attributes
        base = self._evaluator.text(element, "name", scope, place) or UNKNOWN
        name = scope.full_name(base, UNKNOWN if written and own is None else own)
        self._evaluator.choices.decide(scope.behind(Source(NAMESPACE)))
        args, early = self._early(element, scope, place)
        shared = tuple(remaps_at([*early, *(scope.remaps or ())], name))
        rules = remaps_at(self._evaluator.pairs(element.named("remap"), scope, place), name)
        return LaunchNode(
            name=name,
            package=element.plain("pkg"),
            type=element.plain(type),
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
