"""Commands of `ros2` in a launch that load components into a container, or controllers.

Sources: ros2cli, ros2component; ros2_control, ros2controlcli.
"""

from argparse import ArgumentError, ArgumentParser, Namespace
from collections.abc import Iterable, Iterator
from dataclasses import replace
from pathlib import PurePath
from typing import NoReturn

from rtron.sources.launch.ros2.parameters.file import parse_value
from rtron.sources.launch.ros2.parameters.merge import ALL_NODES, ParameterSource
from rtron.sources.launch.ros2.result import LaunchStart, StartKind
from rtron.vocabulary import Evidence
from rtron.vocabulary.launch import canonical_name
from rtron.vocabulary.parameters import Parameter

CONTAINER_PACKAGE = "rclcpp_components"
_CONTAINER = "component_container"
_COMPONENT, _CONTROL = ("ros2", "component"), ("ros2", "control")
_SPAWNER = ("controller_manager", "spawner")
_UNNAMED = "standalone_container_{id}"


class _Parser(ArgumentParser):
    def error(self, message: str) -> NoReturn:
        """Raise what a wrong command line is, instead of ending the process."""
        raise ArgumentError(None, message)


def _component_parser(verb: str) -> _Parser:
    parser = _Parser(add_help=False, allow_abbrev=False)
    for name in (*(("container",) if verb == "load" else ()), "package", "plugin"):
        parser.add_argument(name)
    for flag in ("--node-namespace", "--log-level", "--spin-time"):
        parser.add_argument(flag)
    parser.add_argument("-n", "--node-name", default="")
    parser.add_argument("-c", "--container-node-name", default=_UNNAMED)
    for flags in (("-r", "--remap-rule"), ("-p", "--parameter"), ("-e", "--extra-argument")):
        parser.add_argument(*flags, action="append", default=[])
    return parser


def component_command(process: LaunchStart) -> Iterator[LaunchStart]:
    """Yield the container that a command starts, and the component; nothing for another command."""
    command, verb, words = _split(process)
    given = None
    if command == _COMPONENT and verb in {"load", "standalone"}:
        given = _parsed(_component_parser(verb), words)
    if given is None:
        return
    name = getattr(given, "container", given.container_node_name)
    container = canonical_name(f"/{name}")
    if verb == "standalone":
        yield _container(process, container)
    yield _component(process, container, given)


def controller_command(process: LaunchStart) -> LaunchStart | None:
    """Return the spawner that `ros2 control load_controller` is like; None for another command."""
    command, verb, words = _split(process)
    if (command, verb) != (_CONTROL, "load_controller"):
        return None
    parser = _Parser(add_help=False, allow_abbrev=False)
    parser.add_argument("controller")
    parser.add_argument("file", nargs="?")
    for flags in (("-c", "--controller-manager"), ("--set-state",), ("--spin-time",)):
        parser.add_argument(*flags)
    given = _parsed(parser, words)
    if given is None:
        return None
    manager = ("-c", given.controller_manager) if given.controller_manager else ()
    file = ("-p", given.file) if given.file else ()
    package, program = _SPAWNER
    return replace(
        process,
        kind=StartKind.NODE,
        package=package,
        program=program,
        name="_ros2cli_*",
        arguments=(given.controller, *manager, *file),
    )


def _split(process: LaunchStart) -> tuple[tuple[str, str], str, list[str]]:
    """Return a command's first two words, its verb, and what follows."""
    program, kind, verb, *words = (*process.arguments, "", "", "")
    return (PurePath(program).name, kind), verb, words[:-3]


def _parsed(parser: _Parser, words: list[str]) -> Namespace | None:
    try:
        return parser.parse_known_args(words)[0]
    except ArgumentError:
        return None


def _container(process: LaunchStart, name: str) -> LaunchStart:
    namespace, _, base = name.rpartition("/")
    return replace(
        process,
        kind=StartKind.CONTAINER,
        package=CONTAINER_PACKAGE,
        program=_CONTAINER,
        name=base,
        namespace=namespace or "/",
        arguments=(),
    )


def _component(process: LaunchStart, container: str, given: Namespace) -> LaunchStart:
    parameters = _assignments(given.parameter, process.evidence)
    rules = (rule.partition(":=") for rule in given.remap_rule)
    return replace(
        process,
        kind=StartKind.COMPONENT,
        package=given.package,
        program=given.plugin,
        name=given.node_name,
        namespace=canonical_name(f"/{given.node_namespace or ''}") or "/",
        has_namespace=given.node_namespace is not None,
        container=container,
        remaps=tuple((source, target) for source, _, target in rules),
        parameter_sources=(ParameterSource(entries=((ALL_NODES, parameters),)),),
        extra_arguments=_assignments(given.extra_argument, process.evidence),
        arguments=(),
    )


def _assignments(words: Iterable[str], place: Evidence) -> dict[str, Parameter]:
    pairs = (word.partition(":=") for word in words)
    return {name: Parameter(value=parse_value(text), evidence=place) for name, _, text in pairs}
