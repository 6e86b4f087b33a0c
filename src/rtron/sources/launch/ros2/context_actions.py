"""The actions of ROS 2's launch files that start nothing: what they change for all after them."""

import re
from dataclasses import dataclass, replace
from difflib import get_close_matches

from rtron.sources.launch.common.errors import MissingArgumentError
from rtron.sources.launch.ros2.choices import FALSE, TRUE
from rtron.sources.launch.ros2.element_site import ElementSite, FileInclusion
from rtron.sources.launch.ros2.evaluator import LaunchEvaluator, Setting
from rtron.sources.launch.ros2.launch_context import NAMESPACE, ArgumentOrigin, LaunchVariable
from rtron.sources.launch.ros2.parameters.file import read_text_file
from rtron.sources.launch.ros2.substitutions.template import has_placeholder, placeholder
from rtron.vocabulary import WiringFact, WiringFactKind
from rtron.vocabulary.remap_rules import UNKNOWN_NAME

NAMESPACE_TAGS = frozenset({"push_ros_namespace", "push-ros-namespace"})

CONTEXT_TAGS = NAMESPACE_TAGS | {
    "arg",
    "let",
    "unset",
    "push_vars",
    "pop_vars",
    "set_remap",
    "reset",
    "set_env",
    "unset_env",
    "append_env",
    "reset_env",
    "rep_env",
}
"""What changes the scope for all that comes after it."""

IGNORED_TAGS = frozenset(
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
    }
)
"""What neither starts a node nor changes a name."""
_NEAR_RATIO = 0.8
_MOST_GIVEN, _MOST_DECLARED = 5, 100
"""Among more arguments of an inclusion a near one tells nothing, and comparing takes long."""
_USE = r"(?:LaunchConfiguration\w*\(|launch_configurations(?:\[|\.get\()|\$\(var)"
"""What stands before the name of an argument where a launch file uses it."""


@dataclass(slots=True)
class ContextActions:
    """Applies actions that change the context."""

    evaluator: LaunchEvaluator

    def apply(self, site: ElementSite) -> None:
        """Apply an action of CONTEXT_TAGS."""
        context = site.context
        if site.tag == "arg":
            self._argument(site)
        elif site.tag == "let":
            self.set_configuration(site)
        elif site.tag in NAMESPACE_TAGS:
            self._push_namespace(site)
        elif site.tag == "set_remap":
            context.add_remaps(self.evaluator.remap_rules([site]))
        elif site.tag in {"reset", "push_vars", "pop_vars"}:
            self._all_configurations(site)
        elif site.tag == "unset":
            context.configurations.pop(self.evaluator.text(site, "name") or "", None)
        elif site.tag == "reset_env":
            context.reset_environment(self.evaluator.environ)
        elif site.tag == "rep_env":
            self._replace_environment(site)
        else:
            self._environment_variable(site)

    def set_configuration(self, site: ElementSite) -> None:
        """Set a configuration."""
        for setting in self.evaluator.configurations([site]):
            site.context.set_value(*setting)

    def give_argument(self, site: ElementSite) -> None:
        """Set an argument for a file that is included, and for all after it in the scope."""
        context, name = site.context, site.plain_text("name")
        before, origin = context.configurations.get(name), context.origins.get(name)
        self.set_configuration(site)
        if context.configurations.get(name) != before:
            context.origins[name] = ArgumentOrigin(site.location, is_default=False)
        elif origin:
            context.origins[name] = origin

    def preserved_configurations(self, site: ElementSite) -> list[Setting]:
        """Return the configurations that a group or a reset keeps."""
        return list(self.evaluator.configurations(site.children("keep")))

    def _all_configurations(self, site: ElementSite) -> None:
        context = site.context
        if site.tag == "push_vars":
            context.push_configurations()
        elif site.tag == "pop_vars":
            context.pop_configurations()
        else:
            preserved = self.preserved_configurations(site)
            context.clear()
            for setting in preserved:
                context.set_value(*setting)

    def _push_namespace(self, site: ElementSite) -> None:
        pushed, context = self.evaluator.text(site, "namespace"), site.context
        namespace = context.node_namespace(UNKNOWN_NAME if pushed is None else pushed)
        variable, origin = LaunchVariable(NAMESPACE), context.origins.get(NAMESPACE)
        value = None if namespace == UNKNOWN_NAME else namespace
        if origin and origin.file and not f"{pushed}".startswith("/"):
            is_of_one = origin.file == site.file.path
            self._add_leak(site, NAMESPACE, context.namespace or "", "/", is_likely=is_of_one)
        context.set_value(variable, value, context.dependencies_of(variable))
        if not context.is_uncertain:
            context.origins[NAMESPACE] = ArgumentOrigin(site.location, is_default=False)

    def _replace_environment(self, site: ElementSite) -> None:
        variables = list(self.evaluator.configurations(site.children("env")))
        site.context.reset_environment({})
        for (name, _), value, dependencies in variables:
            site.context.set_value(LaunchVariable(name, is_environment=True), value, dependencies)

    def _environment_variable(self, site: ElementSite) -> None:
        context = site.context
        name = self.evaluator.text(site, "name")
        if name is None:
            return
        value = self.evaluator.value(site, "value")
        dependencies = frozenset(self.evaluator.dependencies)
        variable = LaunchVariable(name, is_environment=True)
        if site.tag == "unset_env":
            context.set_value(variable, None)
            context.unknown.discard(variable)
        elif site.tag == "set_env":
            context.set_value(variable, value, dependencies)
        else:
            longer = self._appended_value(site, name, value)
            context.set_value(variable, longer, dependencies | context.dependencies_of(variable))

    def _appended_value(self, site: ElementSite, name: str, value: str | None) -> str | None:
        """Return what `append_env` makes of a variable, where that is asked for."""
        if not self.evaluator.symbolic or value is None:
            return None
        words = [word for word in (site.context.environ.get(name), value) if word]
        first = site.plain_text("prepend").lower() in {"true", "1", "yes"}
        return (site.plain_text("separator") or ":").join(words[::-1] if first else words)

    def _argument(self, site: ElementSite) -> None:
        context = site.context
        variable = LaunchVariable(site.plain_text("name"))
        self.evaluator.choices.declared.add(variable.name)
        if variable.name in context.configurations or variable in context.unknown:
            self._note_leak(site, variable.name)
            return
        if not site.has("default"):
            self._missing_argument(site, variable)
            return
        value = self.evaluator.value(site, "default")
        self.evaluator.choices.add_default(variable.name, value)
        context.set_value(variable, value, {variable, *self.evaluator.dependencies})
        if not context.is_uncertain:
            context.origins[variable.name] = ArgumentOrigin(site.location, is_default=True)

    def _note_leak(self, site: ElementSite, name: str) -> None:
        """Note an argument that has another value than its default, from a file before this one."""
        value, default = site.context.configurations.get(name, ""), site.plain_text("default")
        origin = site.context.origins.get(name)
        is_known = bool(value and default) and not has_placeholder(value)
        if origin is None or not (origin.file and is_known) or _is_equal(value, default):
            return
        is_switch = value.lower() in TRUE | FALSE
        if is_switch and not origin.is_default:
            return
        is_of_one = not is_switch and (origin.is_default or origin.file == site.file.path)
        is_likely = is_of_one and _names_use(site.location.file, name)
        self._add_leak(site, name, value, default, is_likely=is_likely)

    def _add_leak(
        self, site: ElementSite, name: str, value: str, default: str, *, is_likely: bool
    ) -> None:
        origin = site.context.origins[name]
        kinds = WiringFactKind.POSSIBLE_LEAKED_ARGUMENT, WiringFactKind.LEAKED_ARGUMENT
        fact = WiringFact(
            kind=kinds[is_likely],
            subject=name,
            value=value,
            others=(site.file.path, origin.file, default),
            evidence=(site.location, origin.location),
        )
        self.evaluator.wiring.append(fact)

    def _missing_argument(self, site: ElementSite, variable: LaunchVariable) -> None:
        """Set an argument without a value to a placeholder; raise where none is allowed."""
        if not self.evaluator.symbolic:
            raise MissingArgumentError(variable.name)
        self.evaluator.note_missing(site, variable.name)
        site.context.set_value(variable, placeholder(variable.name), {variable})


def note_undeclared(evaluator: LaunchEvaluator, site: ElementSite, file: FileInclusion) -> None:
    """Note what an inclusion gives and no file behind it knows, if a near argument is not given."""
    declared = evaluator.choices.declared
    places = {each.plain_text("name"): each.location for each in site.children("arg", "let")}
    unused = [] if UNKNOWN_NAME in declared else sorted(places.keys() - declared)
    others = sorted(declared - places.keys())[:_MOST_DECLARED]
    for name in unused[:_MOST_GIVEN]:
        near = [each for each in others if _is_near(name, each)]
        if near and not any(_may_use(path, name) for path in file.paths()):
            kind = WiringFactKind.UNDECLARED_ARGUMENT
            fact = WiringFact(kind=kind, subject=name, value=near[0], others=(file.path,))
            evaluator.wiring.append(replace(fact, evidence=(places[name],)))


def _is_near(name: str, other: str) -> bool:
    """Return whether one name ends with the words of the other, or is spelled alike."""
    shorter, longer = sorted((name, other), key=len)
    is_end = longer.endswith(f"_{shorter}") and longer != f"use_{shorter}"
    return is_end or bool(get_close_matches(name, [other], 1, _NEAR_RATIO))


def _is_equal(value: str, other: str) -> bool:
    """Return whether two values are the same text, switch or number."""
    one, two = value.strip().lower(), other.strip().lower()
    try:
        return one == two or float(one) == float(two)
    except ValueError:
        return any({one, two} <= switches for switches in (TRUE, FALSE))


def _names_use(path: str, name: str) -> bool:
    """Return whether a launch file itself says where it uses an argument."""
    use = rf"{_USE}\s*(?:\w+\s*=\s*)?['\"]?{re.escape(name)}\b"
    return re.search(use, read_text_file(path)) is not None


def _may_use(path: str, name: str) -> bool:
    """Return whether a launch file uses an argument, or looks into all that there are."""
    return _names_use(path, name) or "launch_configurations" in read_text_file(path)
