from launch.core import Substitution, normalize


class ExecutableInPackage(Substitution):
    """Nothing is installed for the double."""

    def __init__(self, executable, package):
        self.executable, self.package = normalize(executable), normalize(package)

    def perform(self, context):
        raise LookupError("the package is not installed")
