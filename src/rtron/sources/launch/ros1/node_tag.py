"""`<node>` and `<test>`: the node that starts, its parameters (ROS wiki: roslaunch/XML/node)."""

from rtron.sources.launch.ros1.environment_tags import note_prefix, read_env
from rtron.sources.launch.ros1.load_state import Reading
from rtron.sources.launch.ros1.loader_context import PrivateParameter, Scope
from rtron.sources.launch.ros1.param_tag import read_private_param
from rtron.sources.launch.ros1.rosparam_tag import read_rosparam, run_rosparam
from rtron.sources.launch.ros1.substitution_args import ANONYMOUS_MARK, as_pattern
from rtron.sources.launch.ros1.tag import Tag
from rtron.vocabulary.launch import LaunchNode, Remap, canonical_name, resolve_name


def read_node(tag: Tag, scope: Scope, place: int, reading: Reading) -> LaunchNode:
    """Return the node that an element starts in a scope; `place` is the element's.

    Raise ValueError for a name or namespace that roslaunch refuses.
    """
    name, inner, notes = _name(tag), scope.inner(tag.optional("ns")), reading.notes
    full_name = canonical_name(f"{inner.namespace}/{name}")
    own = inner.inner(name)
    if tag.clears():
        reading.parameters.clear(own.namespace, scope.doubt)
    _read_children(tag, inner, own, reading)
    note_prefix(tag, notes)
    node = LaunchNode(
        name=as_pattern(full_name),
        package=notes.text(tag, "pkg") or tag.fault("has no 'pkg'"),
        type=notes.text(tag, "type") or tag.fault("has no 'type'"),
        args=as_pattern(notes.text(tag, "args")),
        remaps=tuple(_remap(*names, full_name) for names in inner.remaps.items()),
        environ=tuple((key, as_pattern(value)) for key, value in inner.environ),
        element=place,
        line=tag.line,
        anonymous=ANONYMOUS_MARK in full_name,
        conditional=bool(scope.doubt),
    )
    if node.package == node.type == "rosparam":
        with notes.noting(tag):
            run_rosparam(tag, node, reading)
    return node


def read_remap(tag: Tag, scope: Scope) -> None:
    """Put a `<remap>` in force in a scope, if it applies."""
    if tag.applies():
        scope.remap(tag.required("from"), tag.required("to"))


def _read_children(tag: Tag, inner: Scope, own: Scope, reading: Reading) -> None:
    """Read what stands in a node's element; what `<param>` sets comes after all `<rosparam>`."""
    private = dict[str, PrivateParameter]()
    for child in tag.children():
        kind = child.name.lower()
        with reading.notes.noting(child):
            if kind == "remap":
                read_remap(child, inner)
            elif kind == "env":
                read_env(child, inner, reading.notes)
            elif kind in {"param", "rosparam"}:
                _read_parameters(child, own, private, reading)
    with reading.notes.noting(tag):
        _set_private((*own.private.values(), *private.values()), own, reading)


def _set_private(parameters: tuple[PrivateParameter, ...], own: Scope, reading: Reading) -> None:
    for parameter in parameters:
        name = f"{own.namespace}/{parameter.name.removeprefix('~')}"
        doubt = max(parameter.doubt, own.doubt)
        reading.parameters.set(name, parameter.value, parameter.evidence, doubt)


def _read_parameters(
    tag: Tag, own: Scope, private: dict[str, PrivateParameter], reading: Reading
) -> None:
    counted = reading.notes.counted(tag, own)
    if counted is None:
        return
    if tag.name.lower() == "rosparam":
        read_rosparam(tag, counted, reading)
        return
    parameter = read_private_param(tag, counted, reading)
    name = canonical_name(parameter.name)
    private.pop(name, None)
    private[name] = parameter


def _name(tag: Tag) -> str:
    name = tag.optional("name")
    if tag.name == "test" and not name:
        name = tag.optional("test-name")
    if not name:
        tag.fault("has no name")
    if "/" in name:
        tag.fault(f"name: '{name}' contains a namespace")
    return name


def _remap(written: str, target: str, node: str) -> Remap:
    return Remap(
        written=as_pattern(written),
        written_target=as_pattern(target),
        declared=as_pattern(resolve_name(written, node)),
        target=as_pattern(resolve_name(target, node)),
    )
