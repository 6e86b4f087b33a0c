"""The types of the intermediate representation, as a file writes them."""

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
