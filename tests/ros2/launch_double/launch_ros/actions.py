from launch.actions import ExecuteProcess
from launch.core import Action, normalize, perform

_UNSET = object()


def _space(context, namespace):
    """A namespace as it counts below the pushed one; None where neither is given."""
    base = context.launch_configurations.get("ros_namespace")
    own = None if namespace is None else perform(context, normalize(namespace))
    if base is None and own is None:
        return None
    if own is None:
        joined = base
    elif not base or own.startswith("/"):
        joined = own
    else:
        joined = f"{'' if base == '/' else base}/{own}"
    joined = joined if joined == "/" else joined.rstrip("/")
    return joined if joined.startswith("/") else f"/{joined}"


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
        parameters=None,
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
        self.__descriptions = composable_node_descriptions

    def execute(self, context):
        super().execute(context)
        described = self.__descriptions or ()
        valid = [d for d in described if d.condition() is None or d.condition().evaluate(context)]
        if not valid:
            return None
        return [LoadComposableNodes(composable_node_descriptions=valid, target_container=self)]


class LoadComposableNodes(Action):
    def __init__(self, *, composable_node_descriptions, target_container, **kwargs):
        super().__init__(**kwargs)
        self.__composable_node_descriptions = composable_node_descriptions
        self.__target = target_container

    def execute(self, context):
        for node in self.__composable_node_descriptions:
            condition = node.condition()
            if condition is None or condition.evaluate(context):
                context.loaded.append(self._request(node, context))

    def _request(self, node, context):
        rules = [f"{a}:={b}" for a, b in context.launch_configurations.get("ros_remaps", ())]
        for source, target in node.remappings or ():
            rules.append(f"{perform(context, source)}:={perform(context, target)}")
        name = None if node.node_name is None else perform(context, node.node_name)
        return {"name": name, "namespace": _space(context, node.node_namespace), "rules": rules}
