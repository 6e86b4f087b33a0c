"""A Source that holds its graph: for tests, demos and graphs made by a program."""

from dataclasses import dataclass

from rtron.vocabulary import InteractionGraph


@dataclass(frozen=True, slots=True)
class InMemorySource:
    """A Source of the graph it is given."""

    graph: InteractionGraph

    def read(self) -> InteractionGraph:
        """Return the graph as it is."""
        return self.graph
