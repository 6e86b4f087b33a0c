"""Launch files of well-known packages that a workspace often lacks (docs/models.md: Packages)."""

import re
from pathlib import Path

from rtron.sources.launch.ros2.substitutions.template import has_hole, shown
from rtron.sources.models.packages import known_packages

_IN_PACKAGE = re.compile(r"\{find-pkg-share (\w+)\}/+launch/+(\w+\.launch)(?:\.(?:py|xml|yaml))?")


def known_launch(spelled: str) -> str:
    """Return the file that stands for one of a package that is not here; another as it is."""
    found = _IN_PACKAGE.fullmatch(shown(spelled)) if has_hole(spelled) else None
    path = _file(found[1], f"{found[2]}.xml") if found else None
    return str(path) if path and path.is_file() else spelled


def is_known(package: str) -> bool:
    """Tell whether something stands for a package's launch files."""
    folder = _file(package, "")
    return folder is not None and any(folder.glob("*.launch.xml"))


def _file(package: str, name: str) -> Path | None:
    folder = known_packages().get(package)
    return folder / "launch" / name if folder else None
