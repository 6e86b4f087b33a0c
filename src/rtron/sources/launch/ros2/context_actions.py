"""The actions of ROS 2's launch files that start nothing: what they change for all after them."""

from collections.abc import Iterator
from dataclasses import dataclass

from rtron.sources.launch.common.errors import MissingArgumentError
from rtron.sources.launch.ros2.evaluator import Evaluator
from rtron.sources.launch.ros2.inclusion import Place
from rtron.sources.launch.ros2.launch_context import NAMESPACE, Scope, Source
from rtron.sources.launch.ros2.substitutions.template import hole
from rtron.sources.launch.ros2.xml_yaml.element import Element
from rtron.vocabulary.remap_rules import UNKNOWN

PUSHES = frozenset({"push_ros_namespace", "push-ros-namespace"})

SETTINGS = PUSHES | {
    "arg",
    "let",
    "unset",
    "set_remap",
    "reset",
    "set_env",
    "unset_env",
    "append_env",
    "reset_env",
}
"""What changes the scope for all that comes after it."""

HARMLESS = frozenset(
    {
        "log",
        "log_debug",
        "log_info",
        "log_warning",
        "log_error",
        "shutdown",
        "set_parameter",
        "set_parameters_from_file",
        "set_ros_log_dir",
        "set_use_sim_time",
        "lifecycle_transition",
    }
)
"""What neither starts a node nor changes a name."""


@dataclass(slots=True)
class Settings:
    """Applies actions that change the scope."""

    evaluator: Evaluator

    def apply(
        self,
        element: Element,
        scope: Scope,
        place: Place,
        said: bool | None,  # noqa: FBT001
    ) -> None:
        """Apply an action of SETTINGS; `said` is what its condition says, None if not known."""
        if said is not None or not self.evaluator.symbolic:
            self._apply(element, scope, place)
            return
        before = dict(scope.configurations), dict(scope.environ)
        self._apply(element, scope, place)
        for values, old in zip((scope.configurations, scope.environ), before, strict=True):
            changed = [name for name in values if values[name] != old.get(name)]
            values.update({name: hole(name) for name in changed})

    def _apply(self, element: Element, scope: Scope, place: Place) -> None:
        tag = element.tag
        if tag == "arg":
            self._argument(element, scope, place)
        elif tag == "let":
            self.let(element, scope, place)
        elif tag in PUSHES:
            own = self.evaluator.text(element, "namespace", scope, place)
            space, source = scope.space(UNKNOWN if own is None else own), Source(NAMESPACE)
            scope.put(source, None if space == UNKNOWN else space, scope.behind(source))
        elif tag == "set_remap":
            scope.share(self.evaluator.pairs([element], scope, place))
        elif tag == "reset":
            kept = list(self.kept(element, scope, place))
            scope.clear()
            for item in kept:
                scope.put(*item)
        elif tag == "unset":
            name = self.evaluator.text(element, "name", scope, place)
            scope.configurations.pop(name or "", None)
        elif tag == "reset_env":
            scope.renew(self.evaluator.environ)
        else:
            self._variable(element, scope, place)

    def let(self, element: Element, scope: Scope, place: Place) -> None:
        """Set a configuration."""
        for item in self.evaluator.given([element], scope, place):
            scope.put(*item)

    def kept(
        self, element: Element, scope: Scope, place: Place
    ) -> Iterator[tuple[Source, str | None, frozenset[Source]]]:
        """Yield the configurations that a group or a reset keeps."""
        return self.evaluator.given(element.named("keep"), scope, place)

    def _variable(self, element: Element, scope: Scope, place: Place) -> None:
        name = self.evaluator.text(element, "name", scope, place)
        if name is None:
            return
        value = self.evaluator.value(element, "value", scope, place)
        touched = frozenset(self.evaluator.touched)
        variable = Source(name, environment=True)
        if element.tag == "unset_env":
            scope.put(variable, None)
            scope.unknown.discard(variable)
        elif element.tag == "set_env":
            scope.put(variable, value, touched)
        else:
            longer = self._appended(element, scope, name, value)
            scope.put(variable, longer, touched | scope.behind(variable))

    def _appended(self, element: Element, scope: Scope, name: str, value: str | None) -> str | None:
        """Return what `append_env` makes of a variable, where that is asked for."""
        if not self.evaluator.symbolic or value is None:
            return None
        words = [word for word in (scope.environ.get(name), value) if word]
        first = element.plain("prepend").lower() in {"true", "1", "yes"}
        return (element.plain("separator") or ":").join(words[::-1] if first else words)

    def _argument(self, element: Element, scope: Scope, place: Place) -> None:
        source = Source(element.plain("name"))
        if source.name in scope.configurations or source in scope.unknown:
            return
        if "default" not in element.attributes:
            self._missing(element, source, scope, place)
            return
        value = self.evaluator.value(element, "default", scope, place)
        self.evaluator.choices.default(source.name, value)
        scope.put(source, value, {source, *self.evaluator.touched})

    def _missing(self, element: Element, source: Source, scope: Scope, place: Place) -> None:
        """Take an argument that nobody gave for a hole, if holes may be."""
        if not self.evaluator.symbolic:
            raise MissingArgumentError(source.name)
        self.evaluator.note_missing(element, place, source.name)
        scope.put(source, hole(source.name), {source})
