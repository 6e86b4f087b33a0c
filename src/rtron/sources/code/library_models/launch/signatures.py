"""The classes of launch, launch_ros, nav2_common, ros_gz: modules, and their parameters' names."""

from collections.abc import Mapping


def _signatures(table: str) -> Mapping[str, tuple[str, ...]]:
    """Return the classes of a table, each with the parameters that may be given by position."""
    rows = (row.split() for row in table.split(","))
    return {name: tuple(parameters) for name, *parameters in rows}


_ACTIONS = _signatures(
    """
    AppendEnvironmentVariable name value, DeclareBooleanLaunchArgument name,
    DeclareLaunchArgument name, EmitEvent, ExecuteLocal, ExecuteProcess, ForEach input_values
    function, ForLoop length function, GroupAction actions, IncludeLaunchDescription
    launch_description_source, Log, LogDebug, LogError, LogInfo, LogWarning, OpaqueCoroutine,
    OpaqueFunction, PopEnvironment, PopLaunchConfigurations, PushEnvironment,
    PushLaunchConfigurations, RegisterEventHandler event_handler, ReplaceEnvironmentVariables
    environment, ResetEnvironment, ResetLaunchConfigurations launch_configurations,
    SetEnvironmentVariable name value, SetLaunchConfiguration name value, Shutdown, TimerAction,
    UnregisterEventHandler event_handler, UnsetEnvironmentVariable name,
    UnsetLaunchConfiguration name
    """
)
_ROS_ACTIONS = _signatures(
    """
    ComposableNodeContainer, LifecycleNode, LifecycleTransition, LoadComposableNodes, Node,
    PushROSNamespace namespace, PushRosNamespace namespace, ROSTimer, RosTimer, SetParameter
    name value, SetParametersFromFile filename, SetROSLogDir new_log_dir, SetRemap src dst,
    SetUseSimTime value
    """
)
_SUBSTITUTIONS = _signatures(
    """
    AllSubstitution, AndSubstitution left right, AnonName name, AnySubstitution, Command
    command, EnvironmentVariable name, EqualsSubstitution left right, FileContent path,
    FindExecutable name, ForEachVar name, ForLoopIndex name, IfElseSubstitution condition
    if_value else_value, LaunchConfiguration variable_name, LaunchLogDir, LocalSubstitution
    expression, NotEqualsSubstitution left right, NotSubstitution value, OrSubstitution left
    right, PathJoinSubstitution substitutions, PathSubstitution path, PythonExpression
    expression python_modules, StringJoinSubstitution substitutions delimiter, TextSubstitution,
    ThisLaunchFile, ThisLaunchFileDir
    """
)
_ROS_SUBSTITUTIONS = _signatures(
    """
    ExecutableInPackage executable package, FindPackage package, FindPackagePrefix package,
    FindPackageShare package
    """
)
_CONDITIONS = _signatures(
    """
    IfCondition predicate_expression, LaunchConfigurationEquals launch_configuration_name
    expected_value, LaunchConfigurationNotEquals launch_configuration_name expected_value,
    UnlessCondition predicate_expression
    """
)
_EVENT_HANDLERS = _signatures(
    """
    OnExecutionComplete, OnIncludeLaunchDescription, OnProcessExit, OnProcessIO, OnProcessStart,
    OnShutdown
    """
)
_MATCHERS = _signatures(
    """
    matches_action target_action, matches_executable target_executable, matches_name
    target_name, matches_pid target_pid
    """
)
"""They choose the nodes that an event is for, and start none."""
_ROS_MATCHERS = _signatures("matches_node_name node_name")
_EVENTS = _signatures(
    "Shutdown, ShutdownProcess, SignalProcess, SendProcessTerminate, SendProcessKill"
)
_ROS_EVENTS: Mapping[str, tuple[str, ...]] = {"ChangeState": ()}
_ROS_EVENT_HANDLERS: Mapping[str, tuple[str, ...]] = {"OnStateTransition": ()}
_DESCRIPTION_SOURCES: Mapping[str, tuple[str, ...]] = {
    f"{kind}LaunchDescriptionSource": ("location",)
    for kind in ("Any", "Frontend", "Python", "XML", "YAML")
}
_DESCRIPTIONS = _signatures(
    """
    ComposableLifecycleNode, ComposableNode, Parameter name value, ParameterFile param_file,
    ParameterValue value
    """
)
_NAV2 = _signatures(
    """
    HasNodeParams source_file node_name, LaunchConfigAsBool name, ReplaceString source_file
    replacements condition, RewrittenYaml source_file param_rewrites root_key key_rewrites
    value_rewrites convert_types
    """
)
_LAUNCH: Mapping[str, tuple[str, ...]] = {
    "EventHandler": (),
    "LaunchDescription": ("initial_entities",),
}

_BRIDGE, _SIMULATOR = ("RosGzBridge",), ("GzServer", "GzSpawnModel")

POSITIONAL_PARAMETERS: Mapping[str, tuple[str, ...]] = {
    **_ACTIONS,
    **_ROS_ACTIONS,
    **_SUBSTITUTIONS,
    **_ROS_SUBSTITUTIONS,
    **_CONDITIONS,
    **_EVENT_HANDLERS,
    **_MATCHERS,
    **_ROS_MATCHERS,
    **_EVENTS,
    **_ROS_EVENTS,
    **_ROS_EVENT_HANDLERS,
    **_DESCRIPTION_SOURCES,
    **_DESCRIPTIONS,
    **_NAV2,
    **_LAUNCH,
    **dict.fromkeys(("Executable", "ReadyToTest", *_BRIDGE, *_SIMULATOR), ()),
}
"""The classes, and the names of those parameters that may be given by position."""

CLASSES_BY_MODULE: Mapping[str, tuple[str, ...]] = {
    "launch": tuple(_LAUNCH),
    "launch.launch_description": ("LaunchDescription",),
    "launch.event_handler": ("EventHandler",),
    "launch.actions": tuple(_ACTIONS),
    "launch.substitutions": tuple(_SUBSTITUTIONS),
    "launch.conditions": tuple(_CONDITIONS),
    "launch.event_handlers": tuple(_EVENT_HANDLERS),
    "launch.events": (*_MATCHERS, "Shutdown"),
    "launch.events.process": tuple(_EVENTS),
    "launch.events.matchers": tuple(_MATCHERS),
    "launch.descriptions": ("Executable",),
    "launch.launch_description_sources": tuple(_DESCRIPTION_SOURCES),
    "launch_xml.launch_description_sources": ("XMLLaunchDescriptionSource",),
    "launch_yaml.launch_description_sources": ("YAMLLaunchDescriptionSource",),
    "launch_ros.actions": tuple(_ROS_ACTIONS),
    "launch_ros.substitutions": (*_ROS_SUBSTITUTIONS, "Parameter"),
    "launch_ros.events.lifecycle": tuple(_ROS_EVENTS),
    "launch_ros.events.matchers": tuple(_ROS_MATCHERS),
    "launch_ros.event_handlers": tuple(_ROS_EVENT_HANDLERS),
    "launch_ros.descriptions": tuple(_DESCRIPTIONS),
    "launch_ros.parameter_descriptions": ("Parameter", "ParameterFile", "ParameterValue"),
    "launch_testing.actions": ("ReadyToTest",),
    "nav2_common.launch": tuple(_NAV2),
    "ros_gz_bridge.actions": _BRIDGE,
    "ros_gz_sim.actions": _SIMULATOR,
}
