"""The functions of an app's nodes, wherever the app was read from."""

from dataclasses import dataclass

from rtron.sources.source import Source
from rtron.vocabulary import InteractionGraph
from rtron.workflows.source_app import StaticSource


@dataclass(frozen=True, slots=True)
class WithFunctions:
    """A Source whose nodes have their functions and domains, where these are known."""

    source: Source

    def read(self) -> InteractionGraph:
        """Return the graph; manifests are looked at where the app is read from source."""
        from rtron.functions.node_functions import with_functions  # noqa: PLC0415 - only what is scanned needs it

        graph = self.source.read()
        if isinstance(self.source, StaticSource):
            return with_functions(graph, self.source.descriptions(graph))
        return with_functions(graph)
