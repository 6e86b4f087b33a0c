"""The launch actions of ros_gz: each includes the launch file of its name (ros_gz 2.1).

It gives all arguments, those of its own defaults too: what an earlier inclusion was given is not
left for it.
"""

from collections.abc import Mapping

from rtron.sources.launch.ros2.substitutions.template import SubstitutionCall
from rtron.sources.launch.ros2.xml_yaml.element import Element

_CONTAINER = {
    "container_name": "ros_gz_container",
    "create_own_container": "False",
    "use_composition": "False",
}
_DEFAULTS: Mapping[str, Mapping[str, str]] = {
    "gz_server": {"world_sdf_file": "", **_CONTAINER},
    "gz_spawn_model": dict.fromkeys(("file", "model_string", "topic", "entity_name"), ""),
    "ros_gz_bridge": {"namespace": "", **_CONTAINER},
}
GAZEBO_ACTIONS = frozenset(_DEFAULTS)


def as_include(action: Element) -> Element:
    """Return what one of them does, as an inclusion."""
    package = "ros_gz_bridge" if action.tag == "ros_gz_bridge" else "ros_gz_sim"
    arguments_by_name = {**_DEFAULTS[action.tag], **action.attributes}
    arguments = tuple(
        Element("arg", {"name": name, "value": value})
        for name, value in arguments_by_name.items()
        if name not in ("if", "unless")
    )
    file = (SubstitutionCall("find-pkg-share", ((package,),)), f"/launch/{action.tag}.launch.py")
    return Element("include", {"file": file}, arguments).with_location(action.line, action.file)
