"""`<node>` and `<test>`: the node that starts (ROS wiki: roslaunch/XML/node)."""

from rtron.sources.launch.scope import Scope
from rtron.sources.launch.substitution import ANONYMOUS_MARK
from rtron.sources.launch.tag import Tag
from rtron.sources.launch.unresolved import Notes
from rtron.vocabulary.launch import LaunchNode, Remap, canonical_name, resolve_name


def read_node(tag: Tag, scope: Scope, place: int, notes: Notes) -> LaunchNode:
    """Return the node that an element starts in a scope; `place` is the element's.

    Raise ValueError for a name or namespace that roslaunch refuses.
    """
    name, inner = _name(tag), scope.inner(tag.optional("ns"))
    for child in tag.children():
        if child.name.lower() == "remap":
            with notes.noting(child):
                read_remap(child, inner)
    full_name = canonical_name(f"{inner.namespace}/{name}")
    return LaunchNode(
        name=_pattern(full_name),
        package=notes.text(tag, "pkg") or tag.fault("has no 'pkg'"),
        type=notes.text(tag, "type") or tag.fault("has no 'type'"),
        args=_pattern(notes.text(tag, "args")),
        remaps=tuple(_remap(*names, full_name) for names in inner.remaps.items()),
        element=place,
        line=tag.line,
        anonymous=ANONYMOUS_MARK in full_name,
    )


def read_remap(tag: Tag, scope: Scope) -> None:
    """Put a `<remap>` in force in a scope, if it applies."""
    if tag.applies():
        scope.remap(tag.required("from"), tag.required("to"))


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
        written=_pattern(written),
        written_target=_pattern(target),
        declared=_pattern(resolve_name(written, node)),
        target=_pattern(resolve_name(target, node)),
    )


def _pattern(name: str) -> str:
    return name.replace(ANONYMOUS_MARK, "_*")
