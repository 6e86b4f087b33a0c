"""Runs the nodes of the fixture app that has every hard case, as its launch file starts them."""

import re
from functools import cache
from pathlib import Path

import yaml

from rtron.sources.code.program_runner import run_cpp, run_nodelet, run_python
from rtron.sources.code.workspace_sources import WorkspaceSources
from rtron.sources.declaration import NodeInterface, NodeSite
from rtron.sources.launch.common.packages import find_packages
from rtron.sources.launch.ros1.reader import read_launch
from rtron.sources.workspace import Workspace
from rtron.sources.workspace.program import ProgramLanguage
from rtron.vocabulary import Resolution

APP = Path(__file__).parents[2] / "fixtures" / "hardcases"
KINDS = {
    "publish": "publishes",
    "subscribe": "subscribes",
    "service": "services",
    "service_client": "service_clients",
    "action_server": "action_servers",
    "action_client": "action_clients",
}


@cache
def expected():
    return yaml.safe_load((APP / "expected.yaml").read_text())


@cache
def app():
    """Return the workspace, and the launch of its every node."""
    packages = find_packages([APP], {})
    launch = APP / "hard_bringup" / "launch" / "hard.launch"
    return Workspace(packages, [APP]), read_launch(launch, {}, packages, {})


def site_of(node, tree):
    return NodeSite(
        name=node.name,
        args=tuple(node.args.split()),
        parameters=tree.parameters,
        remaps=tuple((remap.declared, remap.target) for remap in node.remaps),
        environ=node.environ,
    )


def run_hard_case(name) -> NodeInterface:
    workspace, tree = app()
    node = next(node for node in tree.nodes() if node.name == name)
    return run_node(node, site_of(node, tree), workspace)


def run_node(node, site, workspace):
    files = WorkspaceSources(workspace)
    if node.package == "nodelet":
        plugin = workspace.nodelet(node.args.split()[1])
        return run_nodelet(plugin.program.sources, plugin.plugin_class.type, site, files)
    program = workspace.executable(node.package, node.type)
    if program.language is ProgramLanguage.PYTHON:
        return run_python(program.sources[0], site, files)
    return run_cpp(program.sources, site, files)


def interface_as_expected(interface):
    """Return an interface as the expectations spell it."""
    spelled = {}
    for declared in interface.declarations:
        name = re.sub(r"\{[^}]*\}", "{}", declared.name)
        words = [declared.type]
        if declared.resolution is not Resolution.LITERAL:
            words.append(str(declared.resolution))
        words += [flag for flag in ("implicit", "latched") if getattr(declared, flag)]
        spelled.setdefault(KINDS[declared.kind], {}).setdefault(name, []).append(" ".join(words))
    starts = sorted(" ".join((start.path, *start.args)) for start in interface.runtime_starts)
    return {
        kind: {n: ", ".join(sorted(t)) for n, t in of.items()} for kind, of in spelled.items()
    } | ({"starts": [start.removeprefix(f"{APP}/") for start in starts]} if starts else {})
