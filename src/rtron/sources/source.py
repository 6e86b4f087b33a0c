"""Where an InteractionGraph comes from: one narrow protocol, whatever stands behind it."""

from typing import Protocol

from rtron.vocabulary import InteractionGraph


class GraphSource(Protocol):
    """Anything that an InteractionGraph can be read from."""

    def read(self) -> InteractionGraph:
        """Return the graph; raise InputError or SourceError when there is none to be had."""
