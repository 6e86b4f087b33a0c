"""What an element gives to the node that it starts: parameters, extra arguments, environment."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise

from rtron.errors import InputError
from rtron.sources.launch.common.yaml_tree import YamlLeaf, YamlMapping, YamlTree, all_entries
from rtron.sources.launch.ros2.command_line import argument_parameters
from rtron.sources.launch.ros2.element_site import ElementSite
from rtron.sources.launch.ros2.evaluator import LaunchEvaluator
from rtron.sources.launch.ros2.parameters.file import parameter_entries, parse_value, string_value
from rtron.sources.launch.ros2.parameters.merge import ALL_NODES, Entries, ParameterSource
from rtron.sources.launch.ros2.substitutions.template import display_text, has_placeholder
from rtron.vocabulary import ParameterValue
from rtron.vocabulary.parameters import Parameter

_STRINGS = frozenset({"str", "string"})
_TRUE = frozenset({"true", "1", "yes", "on"})


@dataclass(frozen=True, slots=True)
class NodeConfiguration:
    """Evaluates what an element gives to the node that it starts."""

    evaluator: LaunchEvaluator
    site: ElementSite

    def node_parameters(self, pattern: str) -> Iterator[ParameterSource]:
        """Yield a node's own parameters, file by file and value by value, in order.

        `pattern` is for which nodes the values count that stand in the launch file itself.
        """
        for param in self.site.children("param"):
            if param.has("from"):
                yield from self._parameter_files(param, "from")
            else:
                yield ParameterSource(entries=((pattern, dict(self._param_values(param))),))

    def command_line_parameters(self, arguments: Sequence[str]) -> Iterator[ParameterSource]:
        """Yield the parameters in a command line, in order (docs.ros.org: ROS arguments)."""
        for pair in pairwise(arguments):
            if pair[0] == "--params-file":
                yield from self._parameter_file(pair[1], self.site, substitutes=False)
            else:
                yield from argument_parameters(pair, self.site.location)

    def global_parameters(self) -> ParameterSource | None:
        """Return what an action gives to all nodes."""
        if self.site.tag == "set_parameters_from_file":
            return next(self._parameter_files(self.site, "filename"), None)
        name = display_text(self._text(self.site, "name"))
        entries = ((ALL_NODES, {name: self._parameter(self.site)}),)
        return ParameterSource(entries=entries)

    def extra_arguments(self) -> Mapping[str, Parameter]:
        """Return the extra arguments of a component."""
        arguments: dict[str, Parameter] = {}
        for argument in self.site.children("extra_arg"):
            arguments.update(self._param_values(argument))
        return arguments

    def environ(self) -> tuple[tuple[str, str], ...]:
        """Return what the launch sets in a process's environment."""
        before = self.evaluator.environ
        now = self.site.context.environ
        changed = {name: value for name, value in now.items() if before.get(name) != value}
        for variable in self.site.children("env"):
            changed[self._text(variable, "name")] = self._text(variable, "value")
        return tuple((display_text(name), display_text(value)) for name, value in changed.items())

    def _param_values(
        self, param: ElementSite, prefix: str = ""
    ) -> Iterator[tuple[str, Parameter]]:
        name = prefix + display_text(self._text(param, "name"))
        inner = tuple(param.children(param.tag))
        for child in inner:
            yield from self._param_values(child, f"{name}.")
        if not inner:
            yield name, self._parameter(param)

    def _parameter(self, param: ElementSite) -> Parameter:
        return Parameter(value=self._value(param), evidence=param.location)

    def _value(self, param: ElementSite) -> ParameterValue:
        items = tuple(param.children("item"))
        if items:
            return _uniform_numbers([self._value(item) for item in items])
        text, separator = self._text(param, "value"), param.plain_text("value-sep")
        if separator:
            return [parse_value(part) for part in text.split(separator)]
        kind = param.plain_text("type")
        if kind in _STRINGS or not text:
            return string_value(text)
        value = parse_value(text)
        return float(value) if kind == "float" and type(value) is int else value

    def _parameter_files(self, site: ElementSite, key: str) -> Iterator[ParameterSource]:
        """Yield what a parameter file says; one that cannot be read is noted.

        One whose name is not known has no entries, and a placeholder in its name.
        """
        substitutes = self._text(site, "allow_substs").lower() in _TRUE
        yield from self._parameter_file(self._text(site, key), site, substitutes=substitutes)

    def _parameter_file(
        self, path: str, site: ElementSite, *, substitutes: bool
    ) -> Iterator[ParameterSource]:
        if has_placeholder(path):
            yield ParameterSource(entries=(), file=path)
            return
        with self.evaluator.collect_errors(site):
            entries = self._file_entries(path, site, substitutes)
            is_malformed = not entries and bool(self.evaluator.files.read(path))
            yield ParameterSource(entries=entries, file=path, is_malformed=is_malformed)

    def _file_entries(self, path: str, site: ElementSite, substitutes: bool) -> Entries:  # noqa: FBT001
        """Return what a file says; that of a plain one is kept once for all nodes."""
        files = self.evaluator.files
        if not substitutes:
            return files.entries(path)
        entries = parameter_entries(self._substituted_tree(files.read(path), site), path)
        self.evaluator.limits.count_values(path, sum(len(values) for _, values in entries))
        return entries

    def _substituted_tree(self, tree: YamlTree, site: ElementSite) -> YamlTree:
        """Return a file's tree with the substitutions in its texts replaced."""
        if isinstance(tree, YamlLeaf):
            return YamlLeaf(value=self._substituted_value(tree.value, site), line=tree.line)
        mapping = YamlMapping()
        for key, inner in all_entries(tree):
            mapping.add(key, self._substituted_tree(inner, site))
        return mapping

    def _substituted_value(self, value: ParameterValue, site: ElementSite) -> ParameterValue:
        if isinstance(value, list):
            return [self._substituted_value(item, site) for item in value]
        if not isinstance(value, str) or "$(" not in value:
            return value
        try:
            return parse_value(self.evaluator.substitution_evaluator(site).evaluate(value))
        except ValueError as error:
            raise InputError(f"{value[:80]}: {error}", path=site.file.path) from None

    def _text(self, site: ElementSite, key: str) -> str:
        return self.evaluator.value(site, key) or ""


def _uniform_numbers(values: list[ParameterValue]) -> list[ParameterValue]:
    """Return a list of numbers as floats if one of them is a float."""
    numbers = {type(value) for value in values}
    return [float(value) for value in values] if numbers == {int, float} else values
