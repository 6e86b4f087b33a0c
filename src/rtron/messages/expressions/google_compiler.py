"""Expressions in Google's CEL: its C++ runtime, which checks types and bounds loops."""

from collections.abc import Callable, Mapping, Sequence
from typing import Any

from google.protobuf.descriptor_pool import DescriptorPool

from rtron.errors import InputError
from rtron.messages.expressions.functions import declarations, expand_functions
from rtron.messages.expressions.number_checks import check_numbers
from rtron.messages.expressions.protobuf_types import AREA, area_value, protobuf_name
from rtron.vocabulary import Area

_MAX_MESSAGE = 300


class GoogleCompiler:
    """Compiles expressions over one message, called `subject`, and areas."""

    def __init__(
        self,
        cel: Any,  # noqa: ANN401 - CEL has no types
        subject: tuple[str, str],
        areas: Mapping[str, Area],
        pool: DescriptorPool,
        points: Sequence[str],
    ) -> None:
        """`subject` are the name and the type, `points` the types of positions in it."""
        name, type = subject
        self._areas = areas
        area_type = cel.cel.Type(protobuf_name(AREA))
        self._env = cel.cel.NewEnv(
            descriptor_pool=pool,
            variables={name: cel.cel.Type(protobuf_name(type)), **dict.fromkeys(areas, area_type)},
            functions=declarations(cel.cel, points),
            extensions=[cel.ext.ext_math.ExtMath()],
        )

    def compile(self, text: str) -> tuple[str, Callable[[Any], Any]]:
        """Return the type of an expression, and what evaluates it; RuntimeError if it is none."""
        compiled = self._env.compile(text)
        expanded = expand_functions(check_numbers(text), self._areas)
        if expanded != text and compiled.return_type().name() == "BOOL":
            compiled = self._compile_expanded(expanded)
        return compiled.return_type().name(), lambda activation: compiled.eval(activation).value()

    def _compile_expanded(self, expanded: str) -> Any:  # noqa: ANN401
        try:
            return self._env.compile(expanded)
        except RuntimeError as error:
            raise InputError(
                f"the expression compares in too deep a way: {str(error)[:_MAX_MESSAGE]}",
                help="name areas directly in inside() and distance(), and nest fewer brackets",
            ) from error

    def activate(self, values: Mapping[str, Any]) -> Any:  # noqa: ANN401
        """Return what expressions over these values are evaluated with."""
        return self._env.Activation(dict(values))

    def area(self, make: Any, area: Area) -> Any:  # noqa: ANN401
        """Return an area as a value; `make` is protobuf's class for it."""
        return area_value(make, area)
