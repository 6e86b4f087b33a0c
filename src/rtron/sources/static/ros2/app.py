"""From folders and launch files of ROS 2 to the interaction graph of the app that they start."""

from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from contextlib import closing
from pathlib import Path

from rtron.errors import InputError
from rtron.sources.code.workspace_sources import WorkspaceSources
from rtron.sources.launch.common.packages import find_packages
from rtron.sources.launch.common.undeclared_arguments import undeclared_arguments
from rtron.sources.launch.common.yaml_tree import YamlTree
from rtron.sources.launch.ros2.app import read_app_launch
from rtron.sources.launch.ros2.result import AppLaunch
from rtron.sources.models import ROS2_LIBRARY, ModelCatalog, load_models
from rtron.sources.static.common.cache import hash_workspace, open_cache
from rtron.sources.static.common.firmware import with_firmware
from rtron.sources.static.common.interface_resolver import InterfaceResolver
from rtron.sources.static.common.launch_paths import LaunchRequest
from rtron.sources.static.common.scan_options import ScanOptions
from rtron.sources.static.common.worker import deep_recursion
from rtron.sources.static.common.worker_pool import WorkerPool
from rtron.sources.static.ros2.app_nodes import AppNodeBuilder
from rtron.sources.static.ros2.assembly import Ros2Assembly, duplicate_nodes
from rtron.sources.static.ros2.controllers import ControllerParts
from rtron.sources.static.ros2.gazebo_plugins import GazeboPluginNodes
from rtron.sources.static.ros2.gazebo_server import GazeboServers
from rtron.sources.static.ros2.hardware import HardwareParts
from rtron.sources.static.ros2.missing_plugins import missing_plugins
from rtron.sources.static.ros2.standard_nodes import add_standard_interface
from rtron.sources.static.ros2.unread_parameters import (
    malformed_files,
    mistyped_parameters,
    sections_without_node,
    unread_parameters,
)
from rtron.sources.workspace import Workspace, shared_workspace
from rtron.vocabulary import InteractionGraph


def read_ros2_workspace(folders: Iterable[Path]) -> Workspace:
    """Return the packages below folders alone: Debian's are of ROS 1."""
    folders_read = tuple(folder.absolute() for folder in folders)
    shared = shared_workspace(folders_read, None)
    if shared is not None:
        return shared
    packages = find_packages(folders_read, {})
    own_packages = {
        n: path for n, path in packages.items() if any(map(path.is_relative_to, folders_read))
    }
    return Workspace(own_packages, folders_read)


def scan_ros2_app(
    folders: Iterable[Path],
    launches: Sequence[LaunchRequest],
    environ: Mapping[str, str],
    options: ScanOptions | None = None,
) -> InteractionGraph:
    """Return the interaction graph of the app that launch files start; nothing of it is run.

    Raise InputError if a given launch file cannot be read, or an argument is missing that it needs;
    what is wrong elsewhere stands in the graph's `unresolved`.
    """
    scan_options, workspace = options or ScanOptions(), read_ros2_workspace(folders)
    files = WorkspaceSources(workspace)
    app_launches = _read_launches(launches, environ, files)
    node_builder = AppNodeBuilder(environ=environ)
    starts = [start for launch in app_launches for start in launch.starts]
    nodes = list(node_builder.build(starts))
    models = load_models(ROS2_LIBRARY)
    gazebo_servers = GazeboServers(GazeboPluginNodes(models, files), environ)
    assembly = Ros2Assembly(workspace=workspace)
    generated_files = _unique_generated_files(app_launches)
    with closing(_interface_resolver(workspace, scan_options, models)) as resolver:
        parts = with_firmware(resolver.resolve_nodes(nodes), resolver)
        assembly.add_wiring(*duplicate_nodes(parts))
        parts += gazebo_servers.plugin_nodes.parts(parts)
        parts += gazebo_servers.parts(node_builder.gazebo_servers)
        controllers = ControllerParts(models, files)
        loaded = [*controllers.parts(parts)]
        assembly.add_wiring(*controllers.untyped(parts))
        loaded += HardwareParts(models, files).parts(parts)
        resolved = resolver.resolve_parts([part for part in loaded if part.task])
        for part in (*parts, *(part for part in loaded if not part.task), *resolved):
            assembly.add_part(add_standard_interface(part, files, generated_files))
        assembly.add_wiring(*unread_parameters([*parts, *resolved]))
        assembly.add_wiring(*missing_plugins(parts))
        assembly.add_wiring(*mistyped_parameters([*parts, *resolved]))
        assembly.add_wiring(*malformed_files(starts))
        assembly.add_wiring(*sections_without_node(parts, set(assembly.nodes), models.own_names))
    assembly.add_wiring_facts()
    for launch in app_launches:
        assembly.add_unresolved(*launch.unresolved)
        assembly.add_wiring(*launch.wiring)
    passed = {name for _, given in launches for name in given}
    declared = {name for launch in app_launches for name in launch.declared}
    assembly.add_unresolved(*undeclared_arguments(passed, declared))
    assembly.add_unresolved(*workspace.unresolved_in(node.package for node in nodes))
    assembly.add_unresolved(*node_builder.unresolved.entries, *gazebo_servers.unresolved.entries)
    return assembly.build(Path(app_launches[0].file).name.split(".")[0] if app_launches else "")


def _interface_resolver(
    workspace: Workspace, scan_options: ScanOptions, models: ModelCatalog
) -> InterfaceResolver:
    state = hash_workspace(workspace) if scan_options.cache else ""
    return InterfaceResolver(
        workspace=workspace,
        cache=open_cache(scan_options.cache, state),
        pool=WorkerPool(
            workspace, scan_options.workers, scan_options.seconds, scan_options.start_method
        ),
        progress=scan_options.progress,
        models=models,
    )


def _read_launches(
    launches: Sequence[LaunchRequest],
    environ: Mapping[str, str],
    files: WorkspaceSources,
) -> list[AppLaunch]:
    with deep_recursion():
        app_launches = [read_app_launch(path, passed, environ, files) for path, passed in launches]
    for launch, (_, passed) in zip(app_launches, launches, strict=True):
        _check_arguments(launch, passed)
        _check_content(launch)
    return app_launches


def _unique_generated_files(app_launches: Sequence[AppLaunch]) -> dict[str, YamlTree]:
    """Return the files that launches make, without those that two of them call the same."""
    trees = [
        (path, tree) for launch in app_launches for path, tree in launch.generated_files.items()
    ]
    times = Counter(path for path, _ in trees)
    return {path: tree for path, tree in trees if times[path] == 1}


def _check_content(launch: AppLaunch) -> None:
    """Raise InputError for a launch file that tells nothing."""
    if launch.unresolved and not (launch.starts or launch.has_includes or launch.arguments):
        first = launch.unresolved[0]
        line = first.evidence[0].line if first.evidence else 0
        message = f"nothing that it starts can be read: {first.what}: {first.why}"
        raise InputError(message, path=launch.file, line=line)


def _check_arguments(launch: AppLaunch, passed: Mapping[str, str]) -> None:
    """Raise InputError where an argument is missing."""
    for argument in launch.arguments:
        if argument.default is None and argument.name not in passed:
            location, help = argument.evidence, f"add {argument.name}:=VALUE"
            message = f"argument '{argument.name}' is not given"
            raise InputError(message, path=location.file, line=location.line, help=help)
