from launch.core import normalize


class ComposableNode:
    def __init__(
        self,
        *,
        package,
        plugin,
        name=None,
        namespace=None,
        remappings=None,
        condition=None,
    ):
        self.package, self.node_plugin = normalize(package), normalize(plugin)
        self.__name = None if name is None else normalize(name)
        self.__namespace = None if namespace is None else normalize(namespace)
        self.__remappings = None
        if remappings:
            self.__remappings = ((normalize(a), normalize(b)) for a, b in remappings)
        self.__condition = condition

    @property
    def node_name(self):
        return self.__name

    @property
    def node_namespace(self):
        return self.__namespace

    @property
    def remappings(self):
        return self.__remappings

    def condition(self):
        return self.__condition
