"""Substitutions of a visit: commands are not run, and what is not installed has its name."""

from collections.abc import Callable
from typing import Any, TypeAlias

from launch.utilities import normalize_to_list_of_substitutions, perform_substitutions

from .visit_record import VisitRecord

Thing: TypeAlias = Any
Method: TypeAlias = Callable[..., Any]

ANONYMOUS_SUFFIX = "_rtron_anonymous"
"""Stands for what launch makes up: it is legal in a name."""


def perform_text(context: Thing, value: Thing) -> str:
    """Return a text with its substitutions performed."""
    if value is None:
        return ""
    return str(perform_substitutions(context, normalize_to_list_of_substitutions(value)))


class SubstitutionPatches:
    """Replaces what asks the system; ends a launch where what is not known decides."""

    def __init__(self, record: VisitRecord) -> None:
        self._record = record
        self._decision_depth = 0

    def perform_command(self, _: Method, substitution: Thing, context: Thing) -> str:
        """Return a mark for what a command would print."""
        return self._record.mark_command(perform_text(context, substitution.command))

    def perform_anon_name(self, _: Method, substitution: Thing, context: Thing) -> str:
        """Return a name that would be another in each launch, so that this can be seen."""
        return perform_text(context, substitution.name) + ANONYMOUS_SUFFIX

    def perform_or_name(self, attribute: str) -> Method:
        """Return what finds a program, or gives its name where it is not installed."""

        def perform(original: Method, substitution: Thing, context: Thing) -> str:
            try:
                return str(original(substitution, context))
            except Exception:  # noqa: BLE001 - a program that is not there need not be: it is not run
                return perform_text(context, getattr(substitution, attribute))

        return perform

    def perform_decision(self, original: Method, substitution: Thing, context: Thing) -> object:
        """Perform a substitution that compares or computes: all in it has to be known."""
        self._decision_depth += 1
        try:
            return original(substitution, context)
        finally:
            self._decision_depth -= 1

    def perform_any(self, original: Method, context: Thing, substitution: Thing) -> object:
        """Perform any substitution; raise RuntimeError if a command's output decides something."""
        result = original(context, substitution)
        command = self._record.command_of_mark(str(result)) if self._decision_depth else ""
        if command:
            raise RuntimeError(f"`{command}` is not run, and what it prints decides here")
        return result
