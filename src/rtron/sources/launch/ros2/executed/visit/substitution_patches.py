"""Substitutions of a visit: commands are not run, and what is not installed has its name."""

from collections.abc import Callable
from typing import Any, TypeAlias

from launch.utilities import normalize_to_list_of_substitutions, perform_substitutions

from .visit_record import Found

Thing: TypeAlias = Any
Method: TypeAlias = Callable[..., Any]

ANONYMOUS = "_rtron_anonymous"
"""Stands for what launch makes up: it is legal in a name."""


def text(context: Thing, written: Thing) -> str:
    """Return a text with its substitutions performed."""
    if written is None:
        return ""
    return str(perform_substitutions(context, normalize_to_list_of_substitutions(written)))


class Substituting:
    """Replaces what asks the system; ends a launch where what is not known decides."""

    def __init__(self, found: Found) -> None:
        self._found = found
        self._deciding = 0

    def command(self, _: Method, substitution: Thing, context: Thing) -> str:
        """Return a mark for what a command would print."""
        return self._found.mark(text(context, substitution.command))

    def anonymous(self, _: Method, substitution: Thing, context: Thing) -> str:
        """Return a name that would be another in each launch, so that this can be seen."""
        return text(context, substitution.name) + ANONYMOUS

    def named(self, attribute: str) -> Method:
        """Return what finds a program, or gives its name where it is not installed."""

        def perform(original: Method, substitution: Thing, context: Thing) -> str:
            try:
                return str(original(substitution, context))
            except Exception:  # noqa: BLE001 - a program that is not there need not be: it is not run
                return text(context, getattr(substitution, attribute))

        return perform

    def deciding(self, original: Method, substitution: Thing, context: Thing) -> object:
        """Perform a substitution that compares or computes: all in it has to be known."""
        self._deciding += 1
        try:
            return original(substitution, context)
        finally:
            self._deciding -= 1

    def performing(self, original: Method, context: Thing, substitution: Thing) -> object:
        """Perform any substitution; raise RuntimeError if a command's output decides something."""
        result = original(context, substitution)
        command = self._found.marked(str(result)) if self._deciding else ""
        if command:
            raise RuntimeError(f"`{command}` is not run, and what it prints decides here")
        return result
