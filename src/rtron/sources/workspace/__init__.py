"""What the packages of a catkin workspace build and install, without building them."""

from rtron.sources.workspace.package import PackageContents, Target, TargetKind
from rtron.sources.workspace.plugin import Plugin, PluginClass
from rtron.sources.workspace.program import Language, Program, digest
from rtron.sources.workspace.workspace import Workspace, read_workspace

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
