"""What the packages of a catkin workspace build and install, without building them."""

from rtron.sources.workspace.catalog import (
    Workspace,
    read_workspace,
    share_workspaces,
    shared_workspace,
)
from rtron.sources.workspace.package_contents import BuildTarget, PackageContents, TargetKind
from rtron.sources.workspace.plugin_description import Plugin, PluginClass
from rtron.sources.workspace.program import Program, ProgramLanguage, program_digest

__all__ = [
    "BuildTarget",
    "PackageContents",
    "Plugin",
    "PluginClass",
    "Program",
    "ProgramLanguage",
    "TargetKind",
    "Workspace",
    "program_digest",
    "read_workspace",
    "share_workspaces",
    "shared_workspace",
]
