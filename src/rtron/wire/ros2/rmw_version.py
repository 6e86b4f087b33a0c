"""Which release of ROS 2 is installed here, as the package.xml of rmw says."""

import re

from rtron.messages.ros2.installed_types import install_prefixes, read_text

Version = tuple[int, int]
"""Major and minor; patches do not change how a structure is laid out."""

IRON: Version = (7, 1)
HUMBLE: Version = (6, 1)
KILTED: Version = (7, 8)
LYRICAL: Version = (7, 10)
"""Versions of rmw by release; Jazzy's is 7.3."""
_VERSION = re.compile(r"<version>\s*(\d{1,4})\.(\d{1,4})\.\d{1,4}\s*</version>")
_MAX_BYTES = 1 << 16


def rmw_version() -> Version | None:
    """Return the version of rmw; None if nothing tells."""
    for prefix in install_prefixes():
        try:
            text = read_text(prefix / "share" / "rmw" / "package.xml", _MAX_BYTES)
        except OSError:
            continue
        found = _VERSION.search(text)
        return (int(found[1]), int(found[2])) if found else None
    return None


def release_name(version: Version | None) -> str:
    """Return what to call a version of rmw in a message."""
    return f"rmw {version[0]}.{version[1]}" if version else "an unknown version of rmw"
