"""A node's command line, as the tools of ROS 1 take it apart (ROS wiki: Remapping Arguments)."""

from collections.abc import Iterator, Sequence
from itertools import takewhile


def user_arguments(args: Sequence[str]) -> list[str]:
    """Return the arguments without `from:=to`, which the client library takes away.

    In ROS 2 it takes all between `--ros-args` and `--`, or the end.
    """
    arguments, in_ros_args = [], False
    for argument in args:
        if argument == "--ros-args" or (in_ros_args and argument == "--"):
            in_ros_args = not in_ros_args
        elif not in_ros_args and ":=" not in argument:
            arguments.append(argument)
    return arguments


def positional(args: Sequence[str], valued: str) -> list[str]:
    """Return the arguments that are no options; `valued` names those that take a value."""
    return [
        argument
        for argument, is_option in _with_option_flags(user_arguments(args), valued.split())
        if not is_option
    ]


def option(args: Sequence[str], names: str) -> str | None:
    """Return the value of the first of the options `names`, as `-o VALUE` or `--option=VALUE`."""
    arguments = user_arguments(args)
    for position, argument in enumerate(arguments):
        name, equals, value = argument.partition("=")
        if name not in names.split():
            continue
        if equals:
            return value
        return arguments[position + 1] if position + 1 < len(arguments) else None
    return None


def has_option(args: Sequence[str], names: str) -> bool:
    """Tell whether one of the options `names` is given; `-ab10` gives `-a` and `-b`."""
    arguments = user_arguments(args)
    options = names.split()
    return any(
        a.partition("=")[0] in options or _is_in_short_options(a, options) for a in arguments
    )


def _is_in_short_options(argument: str, options: Sequence[str]) -> bool:
    letters = takewhile(str.isalpha, argument[1:]) if argument.startswith("-") else ()
    return any(f"-{letter}" in options for letter in letters)


def _with_option_flags(args: Sequence[str], valued: Sequence[str]) -> Iterator[tuple[str, bool]]:
    takes_value = False
    for argument in args:
        is_option = argument.startswith("-") and len(argument) > 1
        yield argument, is_option or takes_value
        takes_value = argument in valued and not takes_value
