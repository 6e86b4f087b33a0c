"""The launch actions of ros_gz: each includes the launch file of its name (ros_gz 2.1)."""

from rtron.sources.launch2.element import Element
from rtron.sources.launch2.pieces import Call

_PACKAGES = {
    "gz_server": "ros_gz_sim",
    "gz_spawn_model": "ros_gz_sim",
    "ros_gz_bridge": "ros_gz_bridge",
}
GAZEBO_ACTIONS = frozenset(_PACKAGES)


def inclusion(action: Element) -> Element:
    """Return what one of them does, as an inclusion."""
    package = Call("find-pkg-share", ((_PACKAGES[action.tag],),))
    given = (pair for pair in action.attributes.items() if pair[0] not in ("if", "unless"))
    arguments = tuple(Element("arg", {"name": name, "value": value}) for name, value in given)
    file = (package, f"/launch/{action.tag}.launch.py")
    return Element("include", {"file": file}, arguments).placed(action.line, action.file)
