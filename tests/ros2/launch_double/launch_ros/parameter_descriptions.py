from pathlib import Path


class ParameterFile:
    def __init__(self, param_file):
        self.param_file = param_file

    def evaluate(self, context):
        return Path(self.param_file)
