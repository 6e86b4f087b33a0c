from types import SimpleNamespace

from launch.core import Action, perform

from launch_ros.actions.namespaces import space_of

_FIELDS = {
    bool: (1, "bool_value"),
    int: (2, "integer_value"),
    float: (3, "double_value"),
    str: (4, "string_value"),
    list: (7, "integer_array_value"),
}


class LoadComposableNodes(Action):
    def __init__(self, *, composable_node_descriptions, target_container, **kwargs):
        super().__init__(**kwargs)
        self.__composable_node_descriptions = composable_node_descriptions
        self.__target_container = target_container

    def execute(self, context):
        for node in self.__composable_node_descriptions:
            condition = node.condition()
            if condition is None or condition.evaluate(context):
                context.loaded.append(_loaded(node, context))


def _loaded(node, context):
    request = get_composable_node_load_request(node, context)
    name = None if node.node_name is None else request.node_name
    return {"name": name, "namespace": request.node_namespace, "rules": request.remap_rules}


def get_composable_node_load_request(node, context):
    """Return the request for a component (composition_interfaces/LoadNode)."""
    if node.condition() is not None and not node.condition().evaluate(context):
        return None
    rules = [f"{a}:={b}" for a, b in context.launch_configurations.get("ros_remaps", ())]
    for source, target in node.remappings or ():
        rules.append(f"{perform(context, source)}:={perform(context, target)}")
    return SimpleNamespace(
        package_name=perform(context, node.package),
        plugin_name=perform(context, node.node_plugin),
        node_name="" if node.node_name is None else perform(context, node.node_name),
        node_namespace=space_of(context, node.node_namespace),
        remap_rules=rules,
        parameters=[_parameter(item) for one in node.parameters for item in one.items()],
        extra_arguments=[_parameter(item) for one in node.extra_arguments for item in one.items()],
    )


def _parameter(item):
    """Return a message of a parameter (rcl_interfaces/Parameter)."""
    name, value = item
    kind, field = _FIELDS[type(value)]
    return SimpleNamespace(name=name, value=SimpleNamespace(**{"type": kind, field: value}))
