"""`<include>`: the scope that an included file begins with (ROS wiki: roslaunch/XML/include)."""

from rtron.sources.launch.common.errors import UnresolvableError
from rtron.sources.launch.ros1.environment_tags import read_env
from rtron.sources.launch.ros1.loader_context import LoaderContext, Uncertainty
from rtron.sources.launch.ros1.substitution_args import Argument
from rtron.sources.launch.ros1.tag import Tag
from rtron.sources.launch.ros1.unresolved import UnresolvedNotes


def included_context(
    tag: Tag, context: LoaderContext, unresolved: UnresolvedNotes
) -> LoaderContext:
    """Return the scope of the included file: its namespace, environment and arguments.

    Raise ValueError for a namespace or argument that roslaunch refuses.
    """
    inner = context.for_included_file(tag.optional("ns"), pass_all=tag.boolean("pass_all_args"))
    for child in tag.children():
        if child.name.lower() == "arg":
            _pass_argument(child, inner)
        elif child.name.lower() == "env":
            with unresolved.collect_errors(child):
                read_env(child, inner, unresolved)
    without_value = inner.declared - set(inner.arguments)
    if without_value:
        tag.fail(f"passes {', '.join(sorted(without_value))} without a value")
    inner.declared.clear()
    return inner


def read_argument(tag: Tag, context: LoaderContext) -> None:
    """Declare an `<arg>` in a scope, with its value or default (ROS wiki: roslaunch/XML/arg)."""
    name = tag.required("name")
    if context.uncertainty is Uncertainty.OWN:
        _read_uncertain(tag, name, context)
        return
    value, default = _value(tag, "value"), _value(tag, "default")
    if value is not None and default is not None:
        tag.fail("has both a value and a default")
    if value is None:
        context.declare_default(name, default)
    else:
        context.set_argument(name, value)


def _read_uncertain(tag: Tag, name: str, context: LoaderContext) -> None:
    """Declare an argument whose condition is not known: only a value given from outside is sure."""
    if tag.element.get("value") is None and name in context.arguments:
        context.declared.add(name)
    else:
        context.declare_unknown(name, f"whether argument '{name}' is set here is not known")


def _pass_argument(tag: Tag, inner: LoaderContext) -> None:
    try:
        applies = tag.applies()
    except UnresolvableError as error:
        inner.declare_unknown(tag.required("name"), str(error))
        return
    if applies:
        read_argument(tag, inner)


def _value(tag: Tag, attribute: str) -> Argument | None:
    try:
        return tag.optional(attribute)
    except UnresolvableError as error:
        return error
