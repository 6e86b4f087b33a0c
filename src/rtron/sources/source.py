"""Where an InteractionGraph comes from: one narrow protocol, whatever stands behind it."""

from dataclasses import dataclass
from typing import Protocol

from rtron.vocabulary import InteractionGraph


class GraphSource(Protocol):
    """Anything that an InteractionGraph can be read from."""

    def read(self) -> InteractionGraph:
        """Return the graph; raise InputError or SourceError when there is none to be had."""
        ...


@dataclass(frozen=True, slots=True)
class InMemorySource:
    """A Source of the graph it is given."""

    graph: InteractionGraph

    def read(self) -> InteractionGraph:
        """Return the graph as it is."""
        return self.graph
