"""The functions of an app's nodes, wherever the app was read from."""

from dataclasses import dataclass

from rtron.sources.source import GraphSource
from rtron.vocabulary import InteractionGraph
from rtron.workflows.source_app import WorkspaceSource


@dataclass(frozen=True, slots=True)
class FunctionAnnotatedSource:
    """A Source whose nodes have their functions and domains, where these are known."""

    source: GraphSource

    def read(self) -> InteractionGraph:
        """Return the graph; manifests are looked at where the app is read from source."""
        from rtron.functions.node_functions import with_functions  # noqa: PLC0415 - only what is scanned needs it

        graph = self.source.read()
        if isinstance(self.source, WorkspaceSource):
            return with_functions(graph, self.source.descriptions(graph))
        return with_functions(graph)
