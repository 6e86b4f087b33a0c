from launch.actions import ExecuteProcess
from launch.core import Action, normalize, perform

from launch_ros.actions.load_composable_nodes import LoadComposableNodes
from launch_ros.actions.namespaces import space_of as _space

__all__ = [
    "ComposableNodeContainer",
    "LoadComposableNodes",
    "Node",
    "PushROSNamespace",
    "PushRosNamespace",
    "SetRemap",
]


class PushROSNamespace(Action):
    def __init__(self, namespace, **kwargs):
        super().__init__(**kwargs)
        self.namespace = namespace

    def execute(self, context):
        context.launch_configurations["ros_namespace"] = _space(context, self.namespace)


PushRosNamespace = PushROSNamespace


class SetRemap(Action):
    def __init__(self, src, dst, **kwargs):
        super().__init__(**kwargs)
        self.src, self.dst = normalize(src), normalize(dst)

    def execute(self, context):
        remaps = context.launch_configurations.get("ros_remaps", [])
        remaps.append((perform(context, self.src), perform(context, self.dst)))
        context.launch_configurations["ros_remaps"] = remaps


class Node(ExecuteProcess):
    def __init__(  # noqa: PLR0913 - as launch_ros has it
        self,
        *,
        executable,
        package=None,
        name=None,
        namespace=None,
        exec_name=None,
        remappings=None,
        ros_arguments=(),
        arguments=(),
        **kwargs,
    ):
        ros = ["--ros-args", *ros_arguments] if ros_arguments else []
        program = executable if package is None else f"/opt/ros/lib/{package}/{executable}"
        super().__init__(cmd=[program, *arguments, *ros, "--ros-args"], name=exec_name, **kwargs)
        self.__name, self.__namespace = name, namespace
        self.__remappings = [(normalize(a), normalize(b)) for a, b in remappings or ()]

    def execute(self, context):
        if self.__name is not None:
            self._add("-r", "__node:=" + perform(context, normalize(self.__name)))
        space = _space(context, self.__namespace)
        if space is not None:
            self._add("-r", f"__ns:={space}")
        own = ((perform(context, a), perform(context, b)) for a, b in self.__remappings)
        for source, target in (*context.launch_configurations.get("ros_remaps", ()), *own):
            self._add("-r", f"{source}:={target}")
        return super().execute(context)

    def _add(self, *words):
        self.cmd.extend(normalize(word) for word in words)


class ComposableNodeContainer(Node):
    def __init__(self, *, name, namespace, composable_node_descriptions=None, **kwargs):
        super().__init__(name=name, namespace=namespace, **kwargs)
        self.__own = normalize(name), normalize(namespace)
        self.__descriptions = composable_node_descriptions

    def execute(self, context):
        super().execute(context)
        space, name = _space(context, self.__own[1]) or "", perform(context, self.__own[0])
        self.node_name = f"{space.rstrip('/')}/{name}"
        described = self.__descriptions or ()
        valid = [d for d in described if d.condition() is None or d.condition().evaluate(context)]
        if not valid:
            return None
        return [LoadComposableNodes(composable_node_descriptions=valid, target_container=self)]
