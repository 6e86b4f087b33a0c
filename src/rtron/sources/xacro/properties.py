"""`<xacro:property>`: a value, a default, a block, or the removal of one (ROS wiki: xacro)."""

from rtron.sources.xacro.evaluation_context import EvaluationContext
from rtron.sources.xacro.scopes import PropertyScope, truth_value
from rtron.sources.xacro.xml_element import XmlElement


def define_property(around: EvaluationContext, element: XmlElement, symbols: PropertyScope) -> None:
    """Set what a `<xacro:property>` says in the scope it says it for.

    Raise ValueError if it is none, and what evaluating it raises.
    """
    name = str(around.evaluate_text(element.attributes.get("name", ""), symbols))
    if not name.isidentifier() or name.startswith("__"):
        raise ValueError(f"'{name}' is no name of a property")
    if truth_value(around.evaluate_text(element.attributes.get("remove", "false"), symbols)):
        symbols.remove(name)
        return
    value, default = element.attributes.get("value"), element.attributes.get("default")
    if default is not None and name in symbols:
        return
    target = _target(element, symbols)
    text = default if value is None else value
    if text is None:
        target.set(f"**{name}", element, lazy=False)
        return
    lazy = target is symbols and truth_value(
        around.evaluate_text(element.attributes.get("lazy_eval", "true"), symbols)
    )
    target.set(name, text if lazy else around.evaluate_text(text, symbols), lazy=lazy)


def _target(element: XmlElement, symbols: PropertyScope) -> PropertyScope:
    scope = element.attributes.get("scope")
    if scope == "global":
        return list(symbols.enclosing_scopes())[-1]
    if scope == "parent":
        caller = symbols.caller_scope()
        if caller is None:
            raise ValueError("has no parent scope")
        return caller
    return symbols
