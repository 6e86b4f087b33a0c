"""Where packages lie, as a launch file in Python asks ament; that of one not here has a hole."""

from collections.abc import Mapping
from functools import partial

from rtron.sources.code.interpreter.abstract_values.value_types import (
    NONE,
    Hole,
    Known,
    Native,
    Value,
    each,
    spelled,
)
from rtron.sources.code.interpreter.execution.abstract_machine import Machine
from rtron.sources.code.interpreter.execution.arguments import Arguments
from rtron.sources.code.library_models.python_std.paths import PathText
from rtron.sources.launch.ros2.substitutions.template import hole


def share_of(machine: Machine, name: Value) -> Value:
    """Return the share folder of a package: in a workspace that is the package itself."""

    def found(one: Value) -> Value:
        if not isinstance(one, Known):
            return Hole(f"find-pkg-share {spelled(one)}")
        path = machine.world.files.package_path(str(one.value))
        return Known(hole(f"find-pkg-share {one.value}") if path is None else str(path))

    return each(name, found)


def package_share(machine: Machine, _: object, arguments: Arguments) -> Value:
    """`get_package_share_directory(name)`, `FindPackageShare("").find(name)`."""
    return share_of(machine, arguments.get(0, "package_name") or NONE)


def _share_path(machine: Machine, _: object, arguments: Arguments) -> Value:
    found = package_share(machine, None, arguments)
    return Known(PathText(found.value)) if isinstance(found, Known) else found


def _prefix(_: Machine, __: object, arguments: Arguments) -> Value:
    """`get_package_prefix(name)`: where it is installed is not known before a build."""

    def found(one: Value) -> Value:
        return Known(hole(f"find-pkg-prefix {spelled(one)}"))

    return each(arguments.get(0, "package_name") or NONE, found)


_CALLS = {
    "get_package_share_directory": package_share,
    "get_package_share_path": _share_path,
    "get_package_prefix": _prefix,
}
LAUNCH_PATHS: Mapping[str, Value] = {
    f"{module}.{name}": Native(name, partial(call))
    for module in ("ament_index_python", "ament_index_python.packages")
    for name, call in _CALLS.items()
}
