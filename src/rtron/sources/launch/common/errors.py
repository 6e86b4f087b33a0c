"""Why a text of a launch file has no value, or a file is not there."""

from pathlib import Path

from rtron.errors import InputError
from rtron.folders import path_exists
from rtron.sources.bounded_file import read_bounded


class UnresolvableError(Exception):
    """A package, whose name it has, an environment variable or an expression without value here."""

    def __init__(self, why: str, package: str = "") -> None:
        super().__init__(why)
        self.package = package


class MissingArgumentError(Exception):
    """An argument is used that nobody gave a value; `name` is the argument."""

    def __init__(self, name: str) -> None:
        super().__init__(f"argument '{name}' has no value")
        self.name = name


_ABSENT = ("no such file", "No such file or directory", "is no file")
_LAUNCH_FILES = (".launch", ".py", ".xml", ".yaml", ".yml")
_PARAMETER_FILES = (".yaml", ".yml")
_BUILD_FILES = ("CMakeLists.txt", "setup.py")
_MOST_BYTES = 2**20


def missing_file(error: InputError) -> str:
    """Return the path of the launch file that was looked for and is not there, else nothing."""
    is_absent = error.reason.startswith(_ABSENT) and error.path.endswith(_LAUNCH_FILES)
    return error.path if is_absent else ""


def missing_parameter_file(error: InputError) -> str:
    """Return the path of a parameter file that its package neither has nor makes, else nothing."""
    path = Path(missing_file(error))
    package = next((each for each in path.parents if path_exists(each / "package.xml")), None)
    if package is None or path.suffix not in _PARAMETER_FILES:
        return ""
    is_made = any(_names(package / build_file, path.name) for build_file in _BUILD_FILES)
    is_made |= any(path.parent.glob(f"{path.name}.*"))
    return "" if is_made else str(path)


def _names(build_file: Path, name: str) -> bool:
    """Return whether a build file names a file, which it may make."""
    if not path_exists(build_file):
        return False
    return name in read_bounded(build_file, _MOST_BYTES).decode("utf-8", "replace")
