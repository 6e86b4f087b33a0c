"""Why a text of a launch file has no value, or a file is not there."""

from pathlib import Path

from rtron.errors import InputError
from rtron.folders import path_exists


class UnresolvableError(Exception):
    """A package, an environment variable or an expression that cannot be resolved here."""


class MissingArgumentError(Exception):
    """An argument is used that nobody gave a value; `name` is the argument."""

    def __init__(self, name: str) -> None:
        super().__init__(f"argument '{name}' has no value")
        self.name = name


def missing_file(error: InputError) -> str:
    """Return the path of the file that an error is about if there is none, else nothing."""
    return "" if not error.path or path_exists(Path(error.path)) else error.path
