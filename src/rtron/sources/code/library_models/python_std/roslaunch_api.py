"""roslaunch's API: the launch files and nodes that a program starts by it (ROS wiki: roslaunch)."""

from collections.abc import Callable, Iterator, Mapping

from rtron.sources.code.interpreter.abstract_values.items import items_of, list_of
from rtron.sources.code.interpreter.abstract_values.value_types import (
    NONE,
    UNKNOWN,
    Instance,
    LibraryClass,
    LibraryFunction,
    ListValue,
    Scalar,
    Unknown,
    Value,
    options,
    text_with_holes,
)
from rtron.sources.code.interpreter.execution.abstract_machine import AbstractMachine
from rtron.sources.code.interpreter.execution.arguments import Arguments
from rtron.sources.code.library_models.common.command_lines import shell_words
from rtron.sources.code.library_models.common.trivial_functions import return_none
from rtron.sources.code.library_models.python_std.argument_parsers import command_line_value
from rtron.sources.code.library_models.python_std.package_paths import missing_package
from rtron.sources.code.library_models.python_std.processes import run_words
from rtron.vocabulary.enums import HiddenPart


def _main(machine: AbstractMachine, _: object, arguments: Arguments) -> Value:
    """`roslaunch.main(["roslaunch", package, file, …])`: the same as the command."""
    given = arguments.get(0, "argv") or command_line_value(machine.recorder.site)
    words, certain = items_of(given)
    run_words(machine, (Scalar("roslaunch"), *words[1:]), arguments, certain=certain)
    return NONE


def _launch_parent(machine: AbstractMachine, _: object, arguments: Arguments) -> Value:
    """`ROSLaunchParent(uuid, files)`; a file may be `(path, arguments)`."""
    _record_files(machine, arguments.get(1, "roslaunch_files") or NONE, arguments)
    if arguments.get(8, "roslaunch_strs") not in {None, NONE}:
        _note_text(machine, None, arguments)
    return Instance(_LAUNCH)


def _record_files(machine: AbstractMachine, given: Value, arguments: Arguments) -> None:
    files, certain = items_of(given)
    for file in files:
        parts = items_of(file)[0] if isinstance(file, ListValue) else (file,)
        words = items_of(parts[1])[0] if len(parts) > 1 else ()
        _record_launch(machine, parts[0] if parts else UNKNOWN, words, arguments)
    if not certain:
        _record_launch(machine, UNKNOWN, (), arguments)


def _record_launch(
    machine: AbstractMachine, path: Value, given: tuple[Value, ...], arguments: Arguments
) -> None:
    for option in options(path):
        if isinstance(option, Scalar):
            words = tuple(text_with_holes(value) for value in given)
            machine.recorder.add_start(str(option.value), words, arguments.evidence)
        else:
            what = f"launch file {text_with_holes(option)}"
            why, hides, package = "its path is not known", HiddenPart.NODES, missing_package(option)
            machine.recorder.add_unresolved(
                what, why, arguments.evidence, hides=hides, package=package
            )


def _load_config(machine: AbstractMachine, _: object, arguments: Arguments) -> Value:
    """`load_config_default(files, port)`."""
    _record_files(machine, arguments.get(0, "roslaunch_files") or NONE, arguments)
    return Instance(_LAUNCH)


def _load_launch(machine: AbstractMachine, _: object, arguments: Arguments) -> Value:
    _record_launch(machine, arguments.value(0), (), arguments)
    return NONE


def _note_text(machine: AbstractMachine, _: object, arguments: Arguments) -> Value:
    what, why = "launch file as a text", "what a program launches from a text is not followed"
    machine.recorder.add_unresolved(what, why, arguments.evidence, hides=HiddenPart.NODES)
    return NONE


def _resolve_launch(_: AbstractMachine, __: object, arguments: Arguments) -> Value:
    """`resolve_launch_arguments([package, file])`: a list of one path; here `package/file`."""
    words, certain = items_of(arguments.get(0) or NONE)
    texts = [str(word.value) for word in words if isinstance(word, Scalar)]
    if not certain or not texts or len(texts) < len(words[:2]):
        return list_of((Unknown("launch file"),))
    return list_of((Scalar("/".join(texts[:2])),))


def _launch_node(machine: AbstractMachine, _: object, arguments: Arguments) -> Value:
    """`roslaunch.core.Node(package, node_type, …)`, started by `ROSLaunch().launch(node)`."""
    package, type = (
        text_with_holes(arguments.value(n, k)) for n, k in ((0, "package"), (1, "node_type"))
    )
    if "{" in package + type:
        what = f"node {package}/{type}"
        machine.recorder.add_unresolved(
            what, "which program it is is not known", arguments.evidence
        )
    else:
        words = ("rosrun", *_node_words(arguments))
        machine.recorder.add_start(f"{package}/{type}", words, arguments.evidence)
    return Instance(_LAUNCH)


def _node_words(arguments: Arguments) -> Iterator[str]:
    """Yield a node's arguments and remaps as a command line has them."""
    given = arguments.get(5, "args") or Scalar("")
    yield from shell_words(text_with_holes(given)) if given != Scalar("") else ()
    for pair in items_of(arguments.get(8, "remap_args") or NONE)[0]:
        yield ":=".join(map(text_with_holes, items_of(pair)[0]))
    for at, key, word in ((2, "name", "__name"), (3, "namespace", "__ns")):
        value = arguments.get(at, key)
        if value is not None and value not in (NONE, Scalar("/")):
            yield f"{word}:={text_with_holes(value)}"


def _make_launch(_: AbstractMachine, __: object, ___: Arguments) -> Value:
    return Instance(_LAUNCH)


_LAUNCH = LibraryClass(
    "roslaunch",
    methods={
        "load": _load_launch,
        "load_str": _note_text,
        "load_string": _note_text,
        **dict.fromkeys(("start", "launch", "shutdown", "spin", "spin_once"), return_none),
    },
)
_LAUNCH_NAMES = (
    *("roslaunch.scriptapi.ROSLaunch", "roslaunch.ROSLaunch", "roslaunch.xmlloader.XmlLoader"),
    "roslaunch.XmlLoader",
)
_CALLS: Mapping[str, Callable[..., Value]] = {
    "roslaunch.main": _main,
    **dict.fromkeys(
        ("roslaunch.parent.ROSLaunchParent", "roslaunch.ROSLaunchParent"), _launch_parent
    ),
    "roslaunch.config.load_config_default": _load_config,
    "roslaunch.rlutil.resolve_launch_arguments": _resolve_launch,
    **dict.fromkeys(_LAUNCH_NAMES, _make_launch),
    **dict.fromkeys(("roslaunch.core.Node", "roslaunch.Node"), _launch_node),
}
ROSLAUNCH_API: Mapping[str, Value] = {
    name: LibraryFunction(name, call) for name, call in _CALLS.items()
}
