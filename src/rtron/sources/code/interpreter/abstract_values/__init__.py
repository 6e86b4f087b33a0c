"""What values are while source is interpreted; library models import it as `av`."""

from rtron.sources.code.interpreter.abstract_values.elements import SLICE, element
from rtron.sources.code.interpreter.abstract_values.items import (
    PAIR,
    items_of,
    key_value,
    list_of,
    pair_of,
)
from rtron.sources.code.interpreter.abstract_values.operators import ARRAY, binary, percent_format
from rtron.sources.code.interpreter.abstract_values.shown_text import repr_of
from rtron.sources.code.interpreter.abstract_values.truth import truth
from rtron.sources.code.interpreter.abstract_values.value_types import (
    FALSE,
    MAX_LENGTH,
    NONE,
    OPEN,
    TRUE,
    UNKNOWN,
    BindPlaceholder,
    Choice,
    ClassValue,
    ExternalSymbol,
    FunctionValue,
    Instance,
    LibraryClass,
    LibraryFunction,
    ListValue,
    MapValue,
    MessageType,
    ModuleValue,
    PartialText,
    Scalar,
    Unknown,
    Value,
    concat,
    is_tainted,
    is_text,
    join,
    map_key,
    map_options,
    options,
    parts_of,
    text_with_holes,
)
