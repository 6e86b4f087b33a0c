import os
import shlex
import shutil
import subprocess

from launch.core import Substitution, TextSubstitution, normalize, perform

__all__ = [
    "AnonName",
    "Command",
    "FindExecutable",
    "LaunchConfiguration",
    "PythonExpression",
    "TextSubstitution",
]


class LaunchConfiguration(Substitution):
    def __init__(self, variable_name, *, default=None):
        self.name, self.default = variable_name, default

    def perform(self, context):
        if self.name not in context.launch_configurations and self.default is not None:
            return perform(context, normalize(self.default))
        return context.launch_configurations[self.name]


class Command(Substitution):
    def __init__(self, command, *, on_stderr="fail"):
        self.command = normalize(command)

    def perform(self, context):
        words = shlex.split(perform(context, self.command))
        return subprocess.run(words, capture_output=True, text=True, check=True).stdout


class AnonName(Substitution):
    def __init__(self, name):
        self.name = normalize(name)

    def perform(self, context):
        return f"{perform(context, self.name)}_{os.getpid()}"


class FindExecutable(Substitution):
    def __init__(self, *, name):
        self.name = normalize(name)

    def perform(self, context):
        found = shutil.which(perform(context, self.name))
        if found is None:
            raise LookupError("executable not found on the PATH")
        return found


class PythonExpression(Substitution):
    def __init__(self, expression):
        self.expression = normalize(expression)

    def perform(self, context):
        return str(eval(perform(context, self.expression)))
