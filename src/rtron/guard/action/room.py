"""How many goals of an action may wait."""

from dataclasses import replace

from rtron.vocabulary import Stream


def with_queue_space(stream: Stream) -> Stream:
    """Let the queue have room for every flow's share, which is bounded before it."""
    first, *others = stream.stages
    size = stream.queue_size * (len(stream.flows) + 1)
    first = replace(first, settings=replace(first.settings, queue_size=size))
    return replace(stream, stages=(first, *others))
