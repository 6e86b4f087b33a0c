"""`<node>` and `<test>`: the node that starts, its parameters (ROS wiki: roslaunch/XML/node)."""

from rtron.sources.launch.common.expression_library import ANONYMOUS_SUFFIX, anonymous_to_wildcard
from rtron.sources.launch.ros1.environment_tags import note_launch_prefix, read_env
from rtron.sources.launch.ros1.loader_context import LoaderContext, PrivateParameter, Tag
from rtron.sources.launch.ros1.param_tag import parse_param
from rtron.sources.launch.ros1.parameter_server import LoadState
from rtron.sources.launch.ros1.rosparam_tag import read_rosparam, run_rosparam
from rtron.vocabulary.launch import LaunchNode, Remap, canonical_name, resolve_name


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
