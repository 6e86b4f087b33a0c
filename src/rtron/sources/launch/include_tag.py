"""`<include>`: the scope that an included file begins with (ROS wiki: roslaunch/XML/include)."""

from rtron.sources.launch.scope import Scope
from rtron.sources.launch.substitution import Argument
from rtron.sources.launch.tag import Tag
from rtron.sources.launch.unresolvable import UnresolvableError


def included_scope(tag: Tag, scope: Scope) -> Scope:
    """Return the scope of the included file: its namespace and the arguments it is given.

    Raise ValueError for a namespace or argument that roslaunch refuses.
    """
    inner = scope.included(tag.optional("ns"), pass_all=bool(tag.flag("pass_all_args")))
    for child in tag.children():
        if child.name.lower() == "arg" and child.applies():
            read_argument(child, inner)
    without_value = inner.declared - set(inner.arguments)
    if without_value:
        tag.fault(f"passes {', '.join(sorted(without_value))} without a value")
    inner.declared.clear()
    return inner


def read_argument(tag: Tag, scope: Scope) -> None:
    """Declare an `<arg>` in a scope, with its value or default (ROS wiki: roslaunch/XML/arg)."""
    name = tag.required("name")
    value, default = _value(tag, "value"), _value(tag, "default")
    if value is not None and default is not None:
        tag.fault("has both a value and a default")
    if value is None:
        scope.default_argument(name, default)
    else:
        scope.set_argument(name, value)


def _value(tag: Tag, attribute: str) -> Argument | None:
    try:
        return tag.optional(attribute)
    except UnresolvableError as error:
        return error
