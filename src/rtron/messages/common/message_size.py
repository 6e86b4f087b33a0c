"""How large the messages of a type are, as far as its definition tells."""

from rtron.messages.common.definition import SIZES, Definition, Field

BYTE_ARRAY_SIZE = 4_000_000
"""What an array of bytes without a bound is taken for: a picture of 1280 x 1024 pixels, a map."""


def usual_size(definition: Definition) -> int:
    """Return how many bytes a message has at least, and more where an array of bytes has no bound.

    Such an array is a picture, a point cloud, a map or a file; of other arrays and of texts nothing
    is known.
    """
    return sum(_field_size(field, definition) for field in definition.fields)


def _field_size(field: Field, definition: Definition) -> int:
    if field.array and field.length is None:
        is_bytes = SIZES.get(field.type) == 1
        return (field.max_elements or BYTE_ARRAY_SIZE) if is_bytes else 0
    nested = definition.nested.get(field.type)
    size = usual_size(nested) if nested else SIZES.get(field.type, 0)
    return size * (field.length or 1)
