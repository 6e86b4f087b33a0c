"""Launch files that stand for those of packages which are not installed here."""

import re
from collections.abc import Mapping
from pathlib import Path

from rtron.sources.launch.ros2.substitutions.template import (
    SubstitutionCall,
    display_text,
    has_placeholder,
)
from rtron.sources.launch.ros2.xml_yaml import Element
from rtron.sources.models.packages import known_packages

_IN_PACKAGE = re.compile(r"\{find-pkg-share (\w+)\}/+launch/+(\w+[._]launch)(?:\.(?:py|xml|yaml))?")


def bundled_launch_file(path_text: str) -> str:
    """Return the file that stands for one of a package that is not here; another as it is."""
    match = _IN_PACKAGE.fullmatch(display_text(path_text)) if has_placeholder(path_text) else None
    folder = _bundled_folder(match[1]) if match else None
    found = (folder / f"{match[2]}.{form}" for form in ("xml", "py")) if match and folder else ()
    return next((str(path) for path in found if path.is_file()), path_text)


def has_bundled_launch_files(package: str) -> bool:
    """Tell whether something stands for a package's launch files."""
    folder = _bundled_folder(package)
    return folder is not None and any(folder.glob("*launch.[xp]*"))


def _bundled_folder(package: str) -> Path | None:
    folder = known_packages().get(package)
    return folder / "launch" if folder else None


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
