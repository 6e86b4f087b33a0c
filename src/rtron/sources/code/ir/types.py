"""The types of the intermediate representation, as a file writes them."""

from collections.abc import Mapping

from rtron.sources.code.record import record


@record(frozen=True, slots=True)
class TypeRef:
    """A type as it is written, without const, & and *: `boost::shared_ptr<std_msgs::String>`.

    A template argument that is a value stands as its text in `name`.
    """

    name: str
    args: tuple["TypeRef", ...] = ()

    def __str__(self) -> str:
        return f"{self.name}<{', '.join(map(str, self.args))}>" if self.args else self.name


def adapter_alias(custom: str) -> str:
    """Return the alias that stands for the message which a type of the program is sent as."""
    return f"rclcpp::ImplicitTypeAdapter<{custom.removeprefix('::')}>"


def alias_parameter(position: int) -> str:
    """Return the name that stands in an alias template for its parameter at a position."""
    return f"<{position}>"


def substituted(type: TypeRef, bindings: Mapping[str, TypeRef]) -> TypeRef:
    """Return a type with each name in it replaced that is bound, in its arguments as well."""
    args = tuple(substituted(arg, bindings) for arg in type.args)
    bound = bindings.get(type.name)
    return TypeRef(type.name, args) if bound is None else TypeRef(bound.name, bound.args or args)
