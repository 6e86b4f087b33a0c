"""Options of a command line as rcutils reads them (rcutils/cmdline_parser.h)."""

from collections.abc import Callable, Mapping

from rtron.sources.code.interpreter.abstract_values.items import items_of
from rtron.sources.code.interpreter.abstract_values.value_types import NONE, Scalar, Unknown, Value
from rtron.sources.code.interpreter.execution.abstract_machine import AbstractMachine
from rtron.sources.code.interpreter.execution.arguments import Arguments

_OPTION = 2


def _words_from_option(arguments: Arguments) -> list[str] | None:
    """Return the command line from the option on; None where one of the two is not known."""
    words, certain = items_of(arguments.get(0) or NONE)
    option = arguments.get(_OPTION)
    texts = [str(word.value) for word in words if isinstance(word, Scalar)]
    if not certain or len(texts) < len(words) or not isinstance(option, Scalar):
        return None
    name = str(option.value)
    return texts[texts.index(name) :] if name in texts else []


def _option_exists(_: AbstractMachine, __: object, arguments: Arguments) -> Value:
    """`rcutils_cli_option_exist(argv, argv + argc, option)`."""
    words = _words_from_option(arguments)
    return Unknown("rcutils_cli_option_exist()") if words is None else Scalar(bool(words))


def _option_value(_: AbstractMachine, __: object, arguments: Arguments) -> Value:
    """`rcutils_cli_get_option(argv, argv + argc, option)`: the word behind it, or a null."""
    words = _words_from_option(arguments)
    if words is None:
        return Unknown("rcutils_cli_get_option()")
    return Scalar(words[1]) if words[1:] else NONE


COMMAND_LINE: Mapping[str, Callable[..., Value]] = {
    "rcutils_cli_option_exist": _option_exists,
    "rcutils_cli_get_option": _option_value,
}
