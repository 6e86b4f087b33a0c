"""What the packages of a catkin workspace build and install, without building them."""

from rtron.sources.workspace.catalog import Workspace, read_workspace
from rtron.sources.workspace.package_contents import PackageContents, Target, TargetKind
from rtron.sources.workspace.plugin_description import Plugin, PluginClass
from rtron.sources.workspace.program import Language, Program, digest

__all__ = [
    "Language",
    "PackageContents",
    "Plugin",
    "PluginClass",
    "Program",
    "Target",
    "TargetKind",
    "Workspace",
    "digest",
    "read_workspace",
]
