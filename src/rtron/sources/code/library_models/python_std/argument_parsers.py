"""Python's argparse and optparse, on the words that a node is started with."""

import argparse
from collections.abc import Callable, Iterator, Mapping
from typing import Any, NoReturn

from rtron.sources.code.interpreter import abstract_values as av
from rtron.sources.code.interpreter.execution.abstract_machine import AbstractMachine
from rtron.sources.code.interpreter.execution.arguments import Arguments
from rtron.sources.code.interpreter.execution.calls import dispatch
from rtron.sources.code.library_models.common.trivial_functions import making, return_owner
from rtron.sources.code.library_models.python_std.builtin_functions import BUILTINS
from rtron.sources.declaration import NodeSite

_ACTIONS = {"store", "store_true", "store_false", "store_const", "append", "append_const", "count"}
_FORWARDED_SETTINGS = ("action", "nargs", "const", "dest")
_VARIADIC_NARGS = {"*", "+", "?", argparse.REMAINDER}
_PARSER_ERRORS = (ValueError, TypeError, IndexError, AttributeError, argparse.ArgumentError)
MAX_WORDS = 64


class _ScriptArgumentParser(argparse.ArgumentParser):
    """Parses the words as far as they fit: a scanned program never ends RTron.

    One positional argument may take any number of words: more make matching them slow.
    """

    has_variadic = False

    def error(self, message: str) -> NoReturn:
        raise ValueError(message)


def command_line_value(site: NodeSite) -> av.ListValue:
    """Return a node's words, the program's name first; open where its command line is unknown."""
    words = (av.Scalar(site.name.rpartition("/")[2]), *map(av.Scalar, site.args))
    return av.list_of(words, certain=site.parameters_complete)


def _add_argument(machine: AbstractMachine, owner: av.Instance, arguments: Arguments) -> av.Value:
    """`add_argument("name" or "--name", default=…)`."""
    option = av.Instance(_OPTION, {"flags": av.list_of(arguments.values), **arguments.keywords})
    machine.undo_log.set(owner.fields, len(owner.fields), option)
    return option


def _add_subparsers(machine: AbstractMachine, owner: av.Instance, arguments: Arguments) -> av.Value:
    """Take what the sub-parsers add for the parser's own; the command is a word before it."""
    dest = arguments.keywords.get("dest", av.Scalar("command"))
    command = arguments.with_values(dest)
    _add_argument(machine, owner, command)
    return owner


def _parse_known(machine: AbstractMachine, owner: av.Instance, arguments: Arguments) -> av.Value:
    return av.list_of(_parse(machine, owner, arguments), "tuple")


def _parse(
    machine: AbstractMachine, owner: av.Instance, arguments: Arguments
) -> tuple[av.Value, av.Value]:
    given = arguments.get(0, "args")
    if given is None or given == av.NONE:
        line = command_line_value(machine.recorder.site)
        given = av.list_of(line.items[1:], certain=not line.open)
    words, certain = av.items_of(given)
    namespace, rest = _namespace(machine, owner, words, arguments)
    return namespace, av.list_of(rest, certain=certain)


def _namespace(
    machine: AbstractMachine, owner: av.Instance, words: tuple[av.Value, ...], at: Arguments
) -> tuple[av.Value, list[av.Value]]:
    """Return the values of all options, and the words that none of them takes."""
    options = [option for option in owner.fields.values() if isinstance(option, av.Instance)]
    parser, found, marked = (
        _ScriptArgumentParser(add_help=False),
        argparse.Namespace(),
        list(_with_stand_ins(words)),
    )
    marks = dict(marked)
    dests = {_add_to_parser(parser, option): option for option in options}
    try:
        _, rest = parser.parse_known_args([text for text, _ in marked], found)
    except _PARSER_ERRORS:
        rest = []
    fields = {
        dest: _option_value(machine, option, getattr(found, dest, None), marks, at)
        for dest, option in dests.items()
        if dest
    }
    return av.Instance(_NAMESPACE, fields), [marks.get(word, av.Scalar(word)) for word in rest]


def _with_stand_ins(words: tuple[av.Value, ...]) -> Iterator[tuple[str, av.Value]]:
    """Yield each word with the text that stands for it, for those that are not known too."""
    for index, word in enumerate(words[:MAX_WORDS]):
        yield (str(word.value) if isinstance(word, av.Scalar) else f"\0{index}"), word


def _add_to_parser(parser: _ScriptArgumentParser, option: av.Instance) -> str:
    """Add an option to the real parser; return where its value goes, empty if it cannot be."""
    flags = [
        str(flag.value)
        for flag in av.items_of(option.fields["flags"])[0]
        if isinstance(flag, av.Scalar)
    ]
    given = {name: option.fields.get(name) for name in _FORWARDED_SETTINGS}
    plain: dict[str, Any] = {n: v.value for n, v in given.items() if isinstance(v, av.Scalar)}
    if plain.get("action", "store") not in _ACTIONS:
        plain = {}
    if not _accepts_nargs(parser, flags, plain.get("nargs")):
        return ""
    try:
        return parser.add_argument(*flags, default=argparse.SUPPRESS, **plain).dest
    except _PARSER_ERRORS:
        return ""


def _accepts_nargs(parser: _ScriptArgumentParser, flags: list[str], count: object) -> bool:
    if isinstance(count, int):
        return count <= MAX_WORDS
    if count not in _VARIADIC_NARGS or (flags[:1] and flags[0].startswith("-")):
        return True
    parser.has_variadic, before = True, parser.has_variadic
    return not before


def _option_value(
    machine: AbstractMachine,
    option: av.Instance,
    found: object,
    marks: Mapping[str, av.Value],
    at: Arguments,
) -> av.Value:
    if isinstance(found, list):
        return av.list_of([_option_value(machine, option, item, marks, at) for item in found])
    if isinstance(found, str):
        return _convert(machine, option, marks.get(found, av.Scalar(found)), at)
    return av.Scalar(found) if found is not None else _option_default(machine, option, at)


def _option_default(machine: AbstractMachine, option: av.Instance, at: Arguments) -> av.Value:
    given, action = option.fields.get("default"), option.fields.get("action", av.NONE)
    is_flag = action in {av.Scalar("store_true"), av.Scalar("store_false")}
    if is_flag and not machine.recorder.site.parameters_complete:
        return av.Unknown("flag")
    if given is not None:
        is_string = isinstance(given, av.Scalar) and isinstance(given.value, str)
        return _convert(machine, option, given, at) if is_string else given
    if is_flag:
        return av.Scalar(action == av.Scalar("store_false"))
    flags = av.items_of(option.fields["flags"])[0]
    first = str(flags[0].value) if flags and isinstance(flags[0], av.Scalar) else "?"
    return av.NONE if first.startswith("-") else av.Unknown(first)


def _convert(
    machine: AbstractMachine, option: av.Instance, word: av.Value, at: Arguments
) -> av.Value:
    type = option.fields.get("type")
    if isinstance(type, av.Scalar):
        type = BUILTINS.get({"string": "str"}.get(str(type.value), str(type.value)))
    if type is None:
        return word
    return dispatch(machine, type, at.with_values(word))


_GROUPS = {
    **dict.fromkeys(
        ("add_argument_group", "add_mutually_exclusive_group", "add_parser"), return_owner
    ),
    "add_subparsers": _add_subparsers,
}
_ARGPARSE = av.LibraryClass(
    "argparse.ArgumentParser",
    methods={
        **_GROUPS,
        "add_argument": _add_argument,
        "parse_args": lambda machine, owner, arguments: _parse(machine, owner, arguments)[0],
        "parse_known_args": _parse_known,
    },
)
_OPTPARSE = av.LibraryClass(
    "optparse.OptionParser",
    methods={
        "add_option": _add_argument,
        "add_option_group": return_owner,
        "parse_args": _parse_known,
    },
)
_NAMESPACE = av.LibraryClass("argparse.Namespace")
_OPTION = av.LibraryClass("argparse.Action")
ARGUMENT_PARSERS: Mapping[str, Callable[..., av.Value]] = {
    "argparse.ArgumentParser": making(_ARGPARSE),
    "optparse.OptionParser": making(_OPTPARSE),
}
