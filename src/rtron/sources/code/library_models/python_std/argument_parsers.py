"""Python's argparse and optparse, on the words that a node is started with."""

import argparse
from collections.abc import Callable, Iterator, Mapping
from typing import Any, NoReturn

from rtron.sources.code.interpreter.abstract_values.items import items_of, listed
from rtron.sources.code.interpreter.abstract_values.value_types import (
    NONE,
    Hole,
    Instance,
    Known,
    ListValue,
    Native,
    NativeClass,
    Value,
)
from rtron.sources.code.interpreter.execution.abstract_machine import Machine
from rtron.sources.code.interpreter.execution.arguments import Arguments
from rtron.sources.code.interpreter.execution.calls import dispatch
from rtron.sources.code.library_models.python_std.builtin_functions import BUILTINS
from rtron.sources.declaration import NodeSite

_ACTIONS = {"store", "store_true", "store_false", "store_const", "append", "append_const", "count"}
_PLAIN = ("action", "nargs", "const", "dest")
_STARRED = {"*", "+", "?", argparse.REMAINDER}
_REFUSED = (ValueError, TypeError, IndexError, AttributeError, argparse.ArgumentError)
MAX_WORDS = 64


class _Parser(argparse.ArgumentParser):
    """Goes by the words as far as they fit: a scanned program never ends this one.

    One positional argument may take any number of words: more make matching them slow.
    """

    starred = False

    def error(self, message: str) -> NoReturn:
        raise ValueError(message)


def command_line(site: NodeSite) -> ListValue:
    """Return a node's words, the program's name first; open where nobody says how it is started."""
    words = (Known(site.name.rpartition("/")[2]), *map(Known, site.args))
    return ListValue({"items": words, "open": not site.complete})


def _parser(_: Machine, __: object, ___: Arguments) -> Value:
    return Instance(_ARGPARSE)


def _option_parser(_: Machine, __: object, ___: Arguments) -> Value:
    return Instance(_OPTPARSE)


def _add_argument(machine: Machine, owner: Instance, arguments: Arguments) -> Value:
    """`add_argument("name" or "--name", default=…)`."""
    option = Instance(_OPTION, {"flags": listed(arguments.values), **arguments.keywords})
    machine.trail.set(owner.fields, len(owner.fields), option)
    return option


def _add_subparsers(machine: Machine, owner: Instance, arguments: Arguments) -> Value:
    """Take what the sub-parsers add for the parser's own; the command is a word before it."""
    dest = arguments.keywords.get("dest", Known("command"))
    command = Arguments(values=(dest,), keywords={}, frame=arguments.frame)
    _add_argument(machine, owner, command)
    return owner


def _parse_args(machine: Machine, owner: Instance, arguments: Arguments) -> Value:
    return _parsed(machine, owner, arguments)[0]


def _parse_known_args(machine: Machine, owner: Instance, arguments: Arguments) -> Value:
    return listed(_parsed(machine, owner, arguments), "tuple")


def _parsed(machine: Machine, owner: Instance, arguments: Arguments) -> tuple[Value, Value]:
    given = arguments.get(0, "args")
    if given is None or given == NONE:
        line = command_line(machine.recorder.site)
        given = ListValue({"items": line.items[1:], "open": line.open})
    words, certain = items_of(given)
    namespace, rest = _namespace(machine, owner, words, arguments)
    return namespace, ListValue({"items": tuple(rest), "open": not certain})


def _namespace(
    machine: Machine, owner: Instance, words: tuple[Value, ...], at: Arguments
) -> tuple[Value, list[Value]]:
    """Return the values of all options, and the words that none of them takes."""
    options = [option for option in owner.fields.values() if isinstance(option, Instance)]
    parser, found, marked = _Parser(add_help=False), argparse.Namespace(), list(_marked(words))
    marks = dict(marked)
    dests = {_added(parser, option): option for option in options}
    try:
        _, rest = parser.parse_known_args([text for text, _ in marked], found)
    except _REFUSED:
        rest = []
    fields = {
        dest: _value(machine, option, getattr(found, dest, None), marks, at)
        for dest, option in dests.items()
        if dest
    }
    return Instance(_NAMESPACE, fields), [marks.get(word, Known(word)) for word in rest]


def _marked(words: tuple[Value, ...]) -> Iterator[tuple[str, Value]]:
    """Yield each word with the text that stands for it, for those that are not known too."""
    for place, word in enumerate(words[:MAX_WORDS]):
        yield (str(word.value) if isinstance(word, Known) else f"\0{place}"), word


def _added(parser: _Parser, option: Instance) -> str:
    """Add an option to the real parser; return where its value goes, empty if it cannot be."""
    flags = [
        str(flag.value) for flag in items_of(option.fields["flags"])[0] if isinstance(flag, Known)
    ]
    given = {name: option.fields.get(name) for name in _PLAIN}
    plain: dict[str, Any] = {n: v.value for n, v in given.items() if isinstance(v, Known)}
    if plain.get("action", "store") not in _ACTIONS:
        plain = {}
    if not _may_take(parser, flags, plain.get("nargs")):
        return ""
    try:
        return parser.add_argument(*flags, default=argparse.SUPPRESS, **plain).dest
    except _REFUSED:
        return ""


def _may_take(parser: _Parser, flags: list[str], count: object) -> bool:
    if isinstance(count, int):
        return count <= MAX_WORDS
    if count not in _STARRED or (flags[:1] and flags[0].startswith("-")):
        return True
    parser.starred, before = True, parser.starred
    return not before


def _value(
    machine: Machine, option: Instance, found: object, marks: Mapping[str, Value], at: Arguments
) -> Value:
    if isinstance(found, list):
        return listed([_value(machine, option, item, marks, at) for item in found])
    if isinstance(found, str):
        return _typed(machine, option, marks.get(found, Known(found)), at)
    return Known(found) if found is not None else _default(machine, option, at)


def _default(machine: Machine, option: Instance, at: Arguments) -> Value:
    given, action = option.fields.get("default"), option.fields.get("action", NONE)
    is_flag = action in {Known("store_true"), Known("store_false")}
    if is_flag and not machine.recorder.site.complete:
        return Hole("flag")
    if given is not None:
        is_text = isinstance(given, Known) and isinstance(given.value, str)
        return _typed(machine, option, given, at) if is_text else given
    if is_flag:
        return Known(action == Known("store_false"))
    flags = items_of(option.fields["flags"])[0]
    first = str(flags[0].value) if flags and isinstance(flags[0], Known) else "?"
    return NONE if first.startswith("-") else Hole(first)


def _typed(machine: Machine, option: Instance, word: Value, at: Arguments) -> Value:
    type = option.fields.get("type")
    if isinstance(type, Known):
        type = BUILTINS.get({"string": "str"}.get(str(type.value), str(type.value)))
    if type is None:
        return word
    return dispatch(machine, type, Arguments(values=(word,), line=at.line, frame=at.frame))


def _itself(_: Machine, owner: Instance, __: Arguments) -> Value:
    return owner


_GROUPS = {
    **dict.fromkeys(("add_argument_group", "add_mutually_exclusive_group", "add_parser"), _itself),
    "add_subparsers": _add_subparsers,
}
_ARGPARSE = NativeClass(
    "argparse.ArgumentParser",
    methods={
        **_GROUPS,
        "add_argument": _add_argument,
        "parse_args": _parse_args,
        "parse_known_args": _parse_known_args,
    },
)
_OPTPARSE = NativeClass(
    "optparse.OptionParser",
    methods={
        "add_option": _add_argument,
        "add_option_group": _itself,
        "parse_args": _parse_known_args,
    },
)
_NAMESPACE = NativeClass("argparse.Namespace")
_OPTION = NativeClass("argparse.Action")
_CALLS: Mapping[str, Callable[..., Value]] = {
    "argparse.ArgumentParser": _parser,
    "optparse.OptionParser": _option_parser,
}
PYTHON_ARGUMENTS: Mapping[str, Value] = {name: Native(name, call) for name, call in _CALLS.items()}
