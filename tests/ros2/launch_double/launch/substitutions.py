from launch.core import Substitution, TextSubstitution, normalize, perform

__all__ = ["LaunchConfiguration", "TextSubstitution"]


class LaunchConfiguration(Substitution):
    def __init__(self, variable_name, *, default=None):
        self.name, self.default = variable_name, default

    def perform(self, context):
        if self.name not in context.launch_configurations and self.default is not None:
            return perform(context, normalize(self.default))
        return context.launch_configurations[self.name]
