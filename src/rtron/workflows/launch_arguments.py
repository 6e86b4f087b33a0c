"""Arguments as roslaunch takes and appends them: `NAME:=VALUE`."""

from collections.abc import Sequence

from rtron.errors import InputError

ASSIGNMENT = ":="


def parse_assignments(arguments: Sequence[str]) -> dict[str, str]:
    """Return the values by name; raise InputError for an argument of another form."""
    for argument in arguments:
        if ASSIGNMENT not in argument or argument.startswith(ASSIGNMENT):
            help = "arguments are NAME:=VALUE, as for roslaunch"
            raise InputError(f"what is {argument!r}?", help=help)
    parts = (argument.partition(ASSIGNMENT) for argument in arguments)
    return {name: value for name, _, value in parts}
