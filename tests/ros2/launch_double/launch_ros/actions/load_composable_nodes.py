from launch.core import Action, perform

from launch_ros.actions.namespaces import space_of


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
    rules = [f"{a}:={b}" for a, b in context.launch_configurations.get("ros_remaps", ())]
    for source, target in node.remappings or ():
        rules.append(f"{perform(context, source)}:={perform(context, target)}")
    name = None if node.node_name is None else perform(context, node.node_name)
    return {"name": name, "namespace": space_of(context, node.node_namespace), "rules": rules}
