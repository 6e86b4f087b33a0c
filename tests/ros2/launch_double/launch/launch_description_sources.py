import importlib.util
from pathlib import Path

from launch.core import LaunchContext, normalize, perform


class LaunchDescriptionSource:
    pass


class AnyLaunchDescriptionSource(LaunchDescriptionSource):
    def __init__(self, launch_file_path):
        self.location = normalize(launch_file_path)
        self.description = None

    def get_launch_description(self, context):
        if self.description is None:
            path = Path(perform(context, self.location)).absolute()
            spec = importlib.util.spec_from_loader("app", None)
            module = importlib.util.module_from_spec(spec)
            module.__file__ = str(path)
            exec(compile(path.read_text(), path, "exec"), module.__dict__)
            self.description = module.generate_launch_description()
        return self.description

    def try_get_launch_description_without_context(self):
        """The place may depend on what only the running launch knows."""
        try:
            return self.get_launch_description(LaunchContext())
        except Exception:  # noqa: BLE001 - as launch does
            return None
