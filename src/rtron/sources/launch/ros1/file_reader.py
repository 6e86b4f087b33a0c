"""Reads one launch file, element by element, and below it the files it includes.

An included file begins with a scope of its own (ROS wiki: roslaunch/XML/include).
"""

import os.path
from dataclasses import dataclass, field

from rtron.errors import InputError
from rtron.sources.launch.common.errors import UnresolvableError
from rtron.sources.launch.common.xml_document import Element, LaunchDocument
from rtron.sources.launch.ros1.loader_context import LoaderContext, Tag, Uncertainty
from rtron.sources.launch.ros1.node_tag import check_machine, read_env, read_node, read_remap
from rtron.sources.launch.ros1.param_tag import read_param
from rtron.sources.launch.ros1.parameter_server import LoadState
from rtron.sources.launch.ros1.rosparam_tag import read_rosparam
from rtron.sources.launch.ros1.substitution_args import Argument, SubstitutionArgs
from rtron.sources.launch.ros1.unresolved import UnresolvedNotes
from rtron.vocabulary import Evidence, LaunchFile, LaunchInclude, LaunchNode, LaunchRemap
from rtron.vocabulary.launch import resolve_name

MAX_DEPTH = 64
MAX_FILES = 1000
MAX_ELEMENTS = 200_000
_STARTERS = ("node", "test", "group", "include")


@dataclass(slots=True, kw_only=True)
class LaunchFileReader:
    """Collects the nodes and includes of one file; `including_files` include it."""

    document: LaunchDocument
    state: LoadState
    including_files: tuple[str, ...] = ()
    _nodes: list[LaunchNode] = field(default_factory=list)
    _includes: list[LaunchInclude] = field(default_factory=list)

    def read(self, context: LoaderContext) -> None:
        """Read the whole file; what was read before an error stays in the result."""
        parameters, outer = self.state.parameters, self.state.parameters.files
        parameters.files = (*self.including_files, self.document.path)
        try:
            self._read_children(self.document.launch, context)
        finally:
            parameters.files = outer

    def result(self) -> LaunchFile:
        """Return what was read."""
        return LaunchFile(
            path=self.document.path, nodes=tuple(self._nodes), includes=tuple(self._includes)
        )

    def _read_children(self, parent: Element, context: LoaderContext) -> None:
        path = self.document.path
        for element in parent.iterchildren("*"):
            tag = Tag(element=element, path=path, substitution=self._substitution(context))
            with self.state.unresolved.collect_errors(tag):
                applied = self.state.unresolved.context_if_applies(tag, context)
                if applied is not None:
                    self._read_element(tag, applied)
                else:
                    skipped = (arg.get("name") for arg in element.iter("arg"))
                    self.state.declared_arguments.update(filter(None, skipped))

    def _read_element(self, tag: Tag, context: LoaderContext) -> None:
        number = self.document.element_numbers[tag.element]
        if tag.name == "arg":
            self.state.declared_arguments.add(tag.optional("name") or "")
            read_argument(tag, context)
        elif tag.name == "group":
            self._group(tag, context.child(tag.optional("ns")))
        elif tag.name == "include":
            self._include(tag, number, included_context(tag, context, self.state.unresolved))
        elif tag.name in {"node", "test"}:
            self._nodes.append(read_node(tag, context, number, self.state))
        elif tag.name == "param":
            read_param(tag, context, self.state)
        elif tag.name == "rosparam":
            read_rosparam(tag, context, self.state)
        elif context.uncertainty is not Uncertainty.OWN:
            self._read_setting(tag, context)

    def _read_setting(self, tag: Tag, context: LoaderContext) -> None:
        """Read an element that is left out where its own condition is not known."""
        if tag.name == "remap":
            read_remap(tag, context)
            self._note_remap_behind_all(tag, context)
        elif tag.name == "env":
            read_env(tag, context, self.state.unresolved)
        elif tag.name == "machine":
            with self.state.unresolved.collect_include_errors(tag):
                check_machine(tag)

    def _note_remap_behind_all(self, tag: Tag, context: LoaderContext) -> None:
        """Keep a remap with nothing behind it in its scope that could start a node."""
        if tag.applies() and not any(e.tag in _STARTERS for e in tag.element.itersiblings()):
            source, target = next(reversed(context.remaps.items()))
            node = f"{context.namespace}/*"
            remap = LaunchRemap(
                source=resolve_name(source, node),
                target=resolve_name(target, node),
                evidence=Evidence(file=tag.path, line=tag.line),
            )
            self.state.remaps_behind_all.append(remap)

    def _group(self, tag: Tag, context: LoaderContext) -> None:
        self._clear(tag, context)
        self._read_children(tag.element, context)

    def _clear(self, tag: Tag, context: LoaderContext) -> None:
        if tag.clears_parameters():
            if tag.element.get("ns") is None:
                tag.fail("has 'clear_params' and no 'ns'")
            self.state.parameters.clear(context.namespace, context.uncertainty)

    def _include(self, tag: Tag, number: int, context: LoaderContext) -> None:
        spelled_path, unresolved = tag.required("file"), self.state.unresolved
        self._clear(tag, context)
        passed = set() if context.passes_all_arguments else set(context.arguments)
        with unresolved.collect_include_errors(tag):
            reader = self._open_included(spelled_path, context)
            with unresolved.collect_include_errors(tag):
                reader.read(context)
                _check_declared(passed - context.declared)
            file = reader.result()
            self._includes.append(
                LaunchInclude(element_index=number, evaluated_name=spelled_path, file=file)
            )

    def _open_included(self, spelled: str, context: LoaderContext) -> "LaunchFileReader":
        """Return a reader of an included file; roslaunch takes it from the current directory."""
        path = os.path.join(os.getcwd(), spelled)  # noqa: PTH109, PTH118 - keep `..`
        including_files = (*self.including_files, self.document.path)
        if len(including_files) > MAX_DEPTH or self.state.include_count == MAX_FILES:
            raise UnresolvableError(f"more than {MAX_DEPTH} includes deep, or {MAX_FILES} in all")
        if context.uncertainty and path in including_files:
            raise UnresolvableError("includes itself, until a condition that is not known ends it")
        self.state.include_count += 1
        document = self.state.documents.launch(path)
        self.state.element_count += len(document.element_numbers)
        if self.state.element_count > MAX_ELEMENTS:
            raise UnresolvableError(f"more than {MAX_ELEMENTS} elements in all included files")
        return LaunchFileReader(
            document=document, state=self.state, including_files=including_files
        )

    def _substitution(self, context: LoaderContext) -> SubstitutionArgs:
        return SubstitutionArgs(
            packages=self.state.packages,
            environ=self.state.environ,
            folder=self.document.folder,
            arguments=context.arguments,
            used=self.state.declared_arguments,
        )


def _check_declared(unused: set[str]) -> None:
    if unused:
        raise InputError(f"does not declare {', '.join(sorted(unused))}; roslaunch refuses that")


def included_context(
    tag: Tag, context: LoaderContext, unresolved: UnresolvedNotes
) -> LoaderContext:
    """Return the scope of the included file: its namespace, environment and arguments.

    Raise ValueError for a namespace or argument that roslaunch refuses.
    """
    inner = context.for_included_file(tag.optional("ns"), pass_all=tag.boolean("pass_all_args"))
    for child in tag.children():
        if child.name.lower() == "arg":
            _pass_argument(child, inner)
        elif child.name.lower() == "env":
            with unresolved.collect_errors(child):
                read_env(child, inner, unresolved)
    without_value = inner.declared - set(inner.arguments)
    if without_value:
        tag.fail(f"passes {', '.join(sorted(without_value))} without a value")
    inner.declared.clear()
    inner.defaults.clear()
    return inner


def read_argument(tag: Tag, context: LoaderContext) -> None:
    """Declare an `<arg>` in a scope, with its value or default (ROS wiki: roslaunch/XML/arg)."""
    name = tag.required("name")
    if context.uncertainty is Uncertainty.OWN:
        _read_uncertain(tag, name, context)
        return
    value, default = _value(tag, "value"), _value(tag, "default")
    if value is not None and default is not None:
        tag.fail("has both a value and a default")
    if value is None:
        context.declare_default(name, default, tag.used_arguments("default"))
    else:
        context.set_argument(name, value)


def _read_uncertain(tag: Tag, name: str, context: LoaderContext) -> None:
    """Declare an argument whose condition is not known: only a value given from outside is sure."""
    if tag.element.get("value") is None and name in context.arguments:
        context.declared.add(name)
    else:
        context.declare_unknown(name, f"whether argument '{name}' is set here is not known")


def _pass_argument(tag: Tag, inner: LoaderContext) -> None:
    try:
        applies = tag.applies()
    except UnresolvableError as error:
        inner.declare_unknown(tag.required("name"), str(error))
        return
    if applies:
        read_argument(tag, inner)


def _value(tag: Tag, attribute: str) -> Argument | None:
    try:
        return tag.optional(attribute)
    except UnresolvableError as error:
        return error
