"""Why a text of a launch file has no value, or a file is not there."""

from rtron.errors import InputError


class UnresolvableError(Exception):
    """A package, an environment variable or an expression that cannot be resolved here."""


class MissingArgumentError(Exception):
    """An argument is used that nobody gave a value; `name` is the argument."""

    def __init__(self, name: str) -> None:
        super().__init__(f"argument '{name}' has no value")
        self.name = name


_ABSENT = ("no such file", "No such file or directory", "is no file")
_LAUNCH_FILES = (".launch", ".py", ".xml", ".yaml", ".yml")


def missing_file(error: InputError) -> str:
    """Return the path of the launch file that was looked for and is not there, else nothing."""
    is_absent = error.reason.startswith(_ABSENT) and error.path.endswith(_LAUNCH_FILES)
    return error.path if is_absent else ""
