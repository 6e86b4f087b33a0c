"""`<node>`, `<test>`, `<env>` and `<machine>`: what starts, where, and what it sees.

ROS wiki: roslaunch/XML/node, roslaunch/XML/env, roslaunch/XML/machine.
"""

from rtron.sources.launch.common.expression_library import ANONYMOUS_SUFFIX, anonymous_to_wildcard
from rtron.sources.launch.ros1.loader_context import LoaderContext, PrivateParameter, Tag
from rtron.sources.launch.ros1.param_tag import parse_param
from rtron.sources.launch.ros1.parameter_server import LoadState
from rtron.sources.launch.ros1.rosparam_tag import read_rosparam, run_rosparam
from rtron.sources.launch.ros1.unresolved import UnresolvedNotes
from rtron.vocabulary.launch import LaunchNode, Remap, canonical_name, resolve_name

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


def read_node(tag: Tag, context: LoaderContext, number: int, state: LoadState) -> LaunchNode:
    """Return the node that an element starts in a scope; `number` is the element's.

    Raise ValueError for a name or namespace that roslaunch refuses.
    """
    name, node_context, unresolved = _name(tag), context.child(tag.optional("ns")), state.unresolved
    full_name = canonical_name(f"{node_context.namespace}/{name}")
    private_context = node_context.child(name)
    if tag.clears_parameters():
        state.parameters.clear(private_context.namespace, context.uncertainty)
    _read_children(tag, node_context, private_context, state)
    note_launch_prefix(tag, unresolved)
    node = LaunchNode(
        name=anonymous_to_wildcard(full_name),
        package=unresolved.text(tag, "pkg") or tag.fail("has no 'pkg'"),
        type=unresolved.text(tag, "type") or tag.fail("has no 'type'"),
        args=anonymous_to_wildcard(unresolved.text(tag, "args")),
        remaps=tuple(_remap(*names, full_name) for names in node_context.remaps.items()),
        environ=tuple((key, anonymous_to_wildcard(value)) for key, value in node_context.environ),
        element_index=number,
        line=tag.line,
        anonymous=ANONYMOUS_SUFFIX in full_name,
        conditional=bool(context.uncertainty),
    )
    if node.package == node.type == "rosparam":
        with unresolved.collect_errors(tag):
            run_rosparam(tag, node, state)
    return node


def read_remap(tag: Tag, context: LoaderContext) -> None:
    """Put a `<remap>` in force in a scope, if it applies."""
    if tag.applies():
        context.remap(tag.required("from"), tag.required("to"))


def _read_children(
    tag: Tag, node_context: LoaderContext, private_context: LoaderContext, state: LoadState
) -> None:
    """Read what stands in a node's element; what `<param>` sets comes after all `<rosparam>`."""
    private = dict[str, PrivateParameter]()
    for child in tag.children():
        kind = child.name.lower()
        with state.unresolved.collect_errors(child):
            if kind == "remap":
                read_remap(child, node_context)
            elif kind == "env":
                read_env(child, node_context, state.unresolved)
            elif kind in {"param", "rosparam"}:
                _read_parameters(child, private_context, private, state)
    with state.unresolved.collect_errors(tag):
        _set_private((*private_context.private.values(), *private.values()), private_context, state)


def _set_private(
    parameters: tuple[PrivateParameter, ...], private_context: LoaderContext, state: LoadState
) -> None:
    for parameter in parameters:
        name = f"{private_context.namespace}/{parameter.name.removeprefix('~')}"
        uncertainty = max(parameter.uncertainty, private_context.uncertainty)
        state.parameters.set(name, parameter.value, parameter.evidence, uncertainty)


def _read_parameters(
    tag: Tag, private_context: LoaderContext, private: dict[str, PrivateParameter], state: LoadState
) -> None:
    applied = state.unresolved.context_if_applies(tag, private_context)
    if applied is None:
        return
    if tag.name.lower() == "rosparam":
        read_rosparam(tag, applied, state)
        return
    parameter = parse_param(tag, applied, state)
    name = canonical_name(parameter.name)
    private.pop(name, None)
    private[name] = parameter


def _name(tag: Tag) -> str:
    name = tag.optional("name")
    if tag.name == "test" and not name:
        name = tag.optional("test-name")
    if not name:
        tag.fail("has no name")
    if "/" in name:
        tag.fail(f"name: '{name}' contains a namespace")
    return name


def _remap(name: str, target: str, node: str) -> Remap:
    return Remap(
        written_source=anonymous_to_wildcard(name),
        written_target=anonymous_to_wildcard(target),
        source=anonymous_to_wildcard(resolve_name(name, node)),
        target=anonymous_to_wildcard(resolve_name(target, node)),
    )


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
