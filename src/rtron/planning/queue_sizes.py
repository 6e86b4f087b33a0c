"""How many messages of a topic can wait: the guard keeps some bytes for each queue, no more."""

from collections.abc import Iterator

from rtron.errors import InputError
from rtron.messages.common.definition import SIZES, Definition, Field
from rtron.messages.common.definition_registry import DefinitionRegistry
from rtron.vocabulary import GRCN, Mode, Plan
from rtron.vocabulary.plan import MAX_QUEUE_BYTES

BYTE_ARRAY_SIZE = 4_000_000
"""What an array of bytes without a bound is taken for: a picture of 1280 x 1024 pixels, a map."""


def usual_size(definition: Definition) -> int:
    """Return how many bytes a message has at least, and more where an array of bytes has no bound.

    Such an array is a picture, a point cloud, a map or a file; of other arrays and of texts nothing
    is known.
    """
    return sum(_field_size(field, definition) for field in definition.fields)


def fitting_queue_size(type: str, definitions: DefinitionRegistry) -> int | None:
    """Return how many messages of a type have room in a queue; None if nothing tells."""
    size = _message_size(type, definitions)
    return _fitting(size) if size else None


def queue_doubts(plan: Plan) -> Iterator[tuple[str, str]]:
    """Yield the queues that may not hold what the plan asks for: where, and why."""
    definitions = DefinitionRegistry(plan.messages, ros=plan.ros)
    for grcn in plan.grcn:
        fitting = fitting_queue_size(grcn.type, definitions)
        if grcn.mode is Mode.ENFORCE and fitting and grcn.queue_size > fitting:
            yield f"GRCN {grcn.id}", _doubt(grcn, _message_size(grcn.type, definitions))


def _doubt(grcn: GRCN, size: int) -> str:
    return (
        f"queue_size is {grcn.queue_size}, and a queue holds {_megabytes(MAX_QUEUE_BYTES)}: of "
        f"{grcn.type}, at {_megabytes(size)} each, {_fitting(size)}; of larger ones, fewer"
    )


def _fitting(size: int) -> int:
    return max(1, MAX_QUEUE_BYTES // size)


def _message_size(type: str, definitions: DefinitionRegistry) -> int:
    """Return how large a message usually is (bytes), 0 if nothing tells."""
    try:
        definition = definitions.find(type) if type else None
    except InputError:  # the plan's own checks report it
        return 0
    return usual_size(definition) if definition else 0


def _megabytes(size: int) -> str:
    return f"{size / 1e6:.2g} MB"


def _field_size(field: Field, definition: Definition) -> int:
    if field.array and field.length is None:
        is_bytes = SIZES.get(field.type) == 1
        return (field.max_elements or BYTE_ARRAY_SIZE) if is_bytes else 0
    nested = definition.nested.get(field.type)
    size = usual_size(nested) if nested else SIZES.get(field.type, 0)
    return size * (field.length or 1)
