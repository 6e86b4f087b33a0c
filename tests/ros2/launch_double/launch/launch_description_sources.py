import importlib.util

from launch.core import normalize, perform


class LaunchDescriptionSource:
    pass


class AnyLaunchDescriptionSource(LaunchDescriptionSource):
    def __init__(self, launch_file_path):
        self.location = normalize(launch_file_path)
        self.description = None

    def get_launch_description(self, context):
        if self.description is None:
            path = perform(context, self.location) if context else self.location[0].text
            spec = importlib.util.spec_from_loader("app", None)
            module = importlib.util.module_from_spec(spec)
            with open(path) as file:
                exec(compile(file.read(), path, "exec"), module.__dict__)
            self.description = module.generate_launch_description()
        return self.description
