"""Why a text of a launch file has no value: neither is a fault of the text itself."""


class UnresolvableError(Exception):
    """A package, an environment variable or an expression that cannot be resolved here."""


class MissingArgumentError(Exception):
    """An argument is used that nobody gave a value; `name` is the argument."""

    def __init__(self, name: str) -> None:
        super().__init__(f"argument '{name}' has no value")
        self.name = name
