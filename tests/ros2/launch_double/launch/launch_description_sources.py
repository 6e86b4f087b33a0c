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
        self.path = str(Path(perform(context, self.location)).absolute())
        if self.description is None:
            self.description = self._read(self.path)
        return self.description

    def try_get_launch_description_without_context(self):
        """Read the file anew if it was not read; its place may depend on the running launch."""
        try:
            return self.description or self._read(perform(LaunchContext(), self.location))
        except Exception:  # noqa: BLE001 - as launch does
            return None

    def _read(self, location):
        path = Path(location).absolute()
        spec = importlib.util.spec_from_loader("app", None)
        module = importlib.util.module_from_spec(spec)
        module.__file__ = str(path)
        exec(compile(path.read_text(), path, "exec"), module.__dict__)
        return module.generate_launch_description()
