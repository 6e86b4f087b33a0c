"""What an element gives to the node that it starts: parameters, extra arguments, environment."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise

from rtron.errors import InputError
from rtron.sources.launch.common.yaml_tree import YamlLeaf, YamlTree
from rtron.sources.launch.ros2.command_line import parameters_in
from rtron.sources.launch.ros2.evaluator import Evaluator
from rtron.sources.launch.ros2.inclusion import Place, evidence_of
from rtron.sources.launch.ros2.launch_context import Scope
from rtron.sources.launch.ros2.parameters.file import entries_of, text_value, yaml_value
from rtron.sources.launch.ros2.parameters.merge import ALL, Entries, ParameterSource
from rtron.sources.launch.ros2.substitutions.template import has_hole, shown
from rtron.sources.launch.ros2.xml_yaml.element import Element
from rtron.vocabulary import ParameterValue
from rtron.vocabulary.parameters import Parameter

_STRINGS = frozenset({"str", "string"})
_YES = frozenset({"true", "1", "yes", "on"})


@dataclass(frozen=True, slots=True)
class Given:
    """Evaluates what elements give at one place."""

    evaluator: Evaluator
    scope: Scope
    place: Place

    def own(self, element: Element, pattern: str) -> Iterator[ParameterSource]:
        """Yield a node's own parameters, file by file and value by value, in order.

        `pattern` is for which nodes the values count that stand in the launch file itself.
        """
        for param in element.named("param"):
            if "from" in param.attributes:
                yield from self._file(param, "from")
            else:
                yield ParameterSource(entries=((pattern, dict(self._values(param, ""))),))

    def in_words(self, words: Sequence[str], element: Element) -> Iterator[ParameterSource]:
        """Yield the parameters in a command line, in order (docs.ros.org: ROS arguments)."""
        for pair in pairwise(words):
            if pair[0] == "--params-file":
                yield from self._named_file(pair[1], element, replaced=False)
            else:
                yield from parameters_in(pair, evidence_of(element, self.place))

    def shared(self, element: Element) -> ParameterSource | None:
        """Return what an action gives to all nodes."""
        if element.tag == "set_parameters_from_file":
            found = next(self._file(element, "filename"), None)
            return found and ParameterSource(entries=found.entries, file=found.file, shared=True)
        name = self._text(element, "name")
        entries = ((ALL, {shown(name): self._parameter(element)}),)
        return ParameterSource(entries=entries, shared=True)

    def extra_arguments(self, element: Element) -> Mapping[str, Parameter]:
        """Return the extra arguments of a component."""
        found: dict[str, Parameter] = {}
        for argument in element.named("extra_arg"):
            found.update(self._values(argument, ""))
        return found

    def environ(self, element: Element) -> tuple[tuple[str, str], ...]:
        """Return what the launch sets in a process's environment."""
        before = self.evaluator.environ
        found = {
            name: value for name, value in self.scope.environ.items() if before.get(name) != value
        }
        for variable in element.named("env"):
            found[self._text(variable, "name")] = self._text(variable, "value")
        return tuple((shown(name), shown(value)) for name, value in found.items())

    def _values(self, param: Element, prefix: str) -> Iterator[tuple[str, Parameter]]:
        name = prefix + shown(self._text(param, "name"))
        inner = tuple(child for child in param.children if child.tag == param.tag)
        for child in inner:
            yield from self._values(child, f"{name}.")
        if not inner:
            yield name, self._parameter(param)

    def _parameter(self, param: Element) -> Parameter:
        return Parameter(value=self._value(param), evidence=evidence_of(param, self.place))

    def _value(self, param: Element) -> ParameterValue:
        items = tuple(param.named("item"))
        if items:
            return _uniform([self._value(item) for item in items])
        text, separator = self._text(param, "value"), param.plain("value-sep")
        if separator:
            return [yaml_value(part) for part in text.split(separator)]
        plain = param.plain("type") in _STRINGS or not text
        return text_value(text) if plain else yaml_value(text)

    def _file(self, element: Element, key: str) -> Iterator[ParameterSource]:
        """Yield what a parameter file says; one that cannot be read is noted.

        One whose name is not known has no entries, and a hole in its name.
        """
        replaced = self._text(element, "allow_substs").lower() in _YES
        yield from self._named_file(self._text(element, key), element, replaced=replaced)

    def _named_file(
        self, path: str, element: Element, *, replaced: bool
    ) -> Iterator[ParameterSource]:
        if has_hole(path):
            yield ParameterSource(entries=(), file=path)
            return
        with self.evaluator.noting(element, self.place):
            yield ParameterSource(entries=self._entries(path, element, replaced), file=path)

    def _entries(self, path: str, element: Element, replaced: bool) -> Entries:  # noqa: FBT001
        """Return what a file says; that of a plain one is kept once for all nodes."""
        files = self.evaluator.files
        if not replaced:
            return files.entries(path)
        entries = entries_of(self._replaced(files.read(path), element), path)
        self.evaluator.bounds.value(path, sum(len(values) for _, values in entries))
        return entries

    def _replaced(self, tree: YamlTree, element: Element) -> YamlTree:
        """Return a file's tree with the substitutions in its texts replaced."""
        if isinstance(tree, YamlLeaf):
            return YamlLeaf(value=self._substituted(tree.value, element), line=tree.line)
        return {key: self._replaced(inner, element) for key, inner in tree.items()}

    def _substituted(self, value: ParameterValue, element: Element) -> ParameterValue:
        if isinstance(value, list):
            return [self._substituted(item, element) for item in value]
        if not isinstance(value, str) or "$(" not in value:
            return value
        replace = self.evaluator.substitution(element, self.scope, self.place).replace
        try:
            return yaml_value(replace(value))
        except ValueError as error:
            raise InputError(f"{value[:80]}: {error}", path=self.place.path) from None

    def _text(self, element: Element, key: str) -> str:
        return self.evaluator.value(element, key, self.scope, self.place) or ""


def _uniform(values: list[ParameterValue]) -> list[ParameterValue]:
    """Return a list of numbers as floats if one of them is a float."""
    numbers = {type(value) for value in values}
    return [float(value) for value in values] if numbers == {int, float} else values
