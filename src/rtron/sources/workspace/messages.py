"""The Python and C++ names that a package's message files bring (ROS wiki: msg, srv, actionlib)."""

from rtron.sources.workspace.package_files import PackageFiles

_ENDINGS = {
    ".msg": ("",),
    ".srv": ("", "Request", "Response"),
    ".action": (
        *("Action", "Goal", "Result", "Feedback"),
        *("ActionGoal", "ActionResult", "ActionFeedback"),
    ),
}


def message_names(files: PackageFiles) -> frozenset[str]:
    """Return the names of the types that are made from *.msg, *.srv and *.action files."""
    names = (name.rpartition("/")[2].rpartition(".") for name in files.names)
    return frozenset(
        stem + ending for stem, dot, suffix in names for ending in _ENDINGS.get(dot + suffix, ())
    )
