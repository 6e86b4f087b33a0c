"""`<env>` and `<machine>`: what the processes of nodes see, and where they run.

ROS wiki: roslaunch/XML/env, roslaunch/XML/machine.
"""

from rtron.sources.launch.ros1.loader_context import LoaderContext, Tag
from rtron.sources.launch.ros1.unresolved import UnresolvedNotes

_OLD_ATTRIBUTES = ("ros-root", "ros-package-path", "ros-ip", "ros-hostname")
_LOADER_VARIABLES = frozenset({"LD_PRELOAD", "LD_LIBRARY_PATH", "PYTHONPATH"})
_KNOWN_PREFIXES = frozenset(
    [
        "chrt",
        "gdb",
        "gnome-terminal",
        "ionice",
        "nice",
        "screen",
        "stdbuf",
        "sudo",
        "taskset",
        "time",
        "valgrind",
        "xterm",
    ]
)
_DEFAULTS = frozenset({"true", "false", "never"})


def read_env(tag: Tag, context: LoaderContext, unresolved: UnresolvedNotes) -> None:
    """Put an `<env>` in force in a scope, if it applies; raise InputError if it is none.

    One that may bring other code into the process is noted.
    """
    if not tag.applies():
        return
    name = tag.required("name")
    value = tag.optional("value")
    if value is None:
        tag.fail("has no 'value'")
    context.environ.append((name, value))
    if name in _LOADER_VARIABLES:
        unresolved.add(tag, f"{name} may bring code into the process that is not looked at")


def note_launch_prefix(tag: Tag, unresolved: UnresolvedNotes) -> None:
    """Note a `launch-prefix` that may run something else than the node."""
    prefix = unresolved.text(tag, "launch-prefix")
    words = prefix.split()
    if words and words[0].rpartition("/")[2] not in _KNOWN_PREFIXES:
        unresolved.add(tag, f"what its launch-prefix '{prefix}' runs is not looked at")


def check_machine(tag: Tag) -> None:
    """Check a `<machine>`, which changes no names; raise InputError as roslaunch does."""
    obsolete = [name for name in _OLD_ATTRIBUTES if tag.optional(name)]
    if obsolete or any(child.name == "env" for child in tag.children()):
        tag.fail("sets an environment; use 'env-loader'")
    for attribute in ("env-loader", "user", "password"):
        tag.optional(attribute)
    for attribute in ("name", "address"):
        if tag.optional(attribute) is None:
            tag.fail(f"has no '{attribute}'")
    if (tag.optional("default") or "false").lower() not in _DEFAULTS:
        tag.fail("default: is none of true, false, never")
    _check_numbers(tag)


def _check_numbers(tag: Tag) -> None:
    timeout = tag.optional("timeout")
    try:
        int(tag.optional("ssh-port") or "22")
        positive = timeout is None or float(timeout) > 0
    except ValueError as error:
        tag.fail(str(error))
    if not positive:
        tag.fail("timeout: is not positive")
