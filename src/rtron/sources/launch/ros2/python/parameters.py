"""Parameters that a Python launch file gives to nodes, as elements (launch_ros: parameters)."""

from collections.abc import Iterator

from rtron.sources.code.interpreter import abstract_values as av
from rtron.sources.code.library_models.launch.constructor_calls import (
    constructor_arguments,
    launch_class_name,
)
from rtron.sources.launch.ros2.python.substitutions import SubstitutionTranslator
from rtron.sources.launch.ros2.substitutions.template import Template, TemplateText, placeholder
from rtron.sources.launch.ros2.xml_yaml import Element

MAX_DEPTH = 24


def parameter_elements(
    translator: SubstitutionTranslator, value: av.Value | None
) -> Iterator[Element]:
    """Yield an element for each parameter, or file of them, in a list of both."""
    items, certain = av.items_of(value) if value is not None else ((), True)
    for item in items:
        for option in av.options(item):
            yield from _source_elements(translator, option)
    if not certain:
        more: dict[str, TemplateText] = {"from": (placeholder("more parameters"),)}
        yield Element("param", more)


def _source_elements(translator: SubstitutionTranslator, value: av.Value) -> Iterator[Element]:
    name = launch_class_name(value)
    if isinstance(value, av.MapValue):
        yield from entry_elements(translator, value)
    elif isinstance(value, av.Instance) and name == "Parameter":
        fields = constructor_arguments(value)
        yield parameter_element(
            translator, translator.template(fields.get("name")), fields.get("value", av.NONE)
        )
    elif value != av.NONE:
        attributes: dict[str, TemplateText] = {"from": translator.template(value)}
        if isinstance(value, av.Instance) and name == "ParameterFile":
            allowed = constructor_arguments(value).get("allow_substs", av.NONE)
            known = av.truth(allowed) if not launch_class_name(allowed) else None
            text = (str(bool(known)),) if known is not None else translator.template(allowed)
            attributes["allow_substs"] = text
        yield Element("param", attributes)


def entry_elements(
    translator: SubstitutionTranslator, value: av.MapValue, tag: str = "param", depth: int = 0
) -> Iterator[Element]:
    """Yield an element for each entry of a dict."""
    translator.count()
    for key, inner in value.entries.items():
        name: Template = (str(key),)
        if isinstance(inner, av.MapValue) and depth < MAX_DEPTH:
            below = tuple(entry_elements(translator, inner, tag, depth + 1))
            yield Element(tag, {"name": name}, below)
        elif inner != av.NONE:
            yield parameter_element(translator, name, inner, tag)


def parameter_element(
    translator: SubstitutionTranslator, name: Template, value: av.Value, tag: str = "param"
) -> Element:
    """Return an element for one parameter; what is a text in Python stays one, unless evaluated."""
    attributes, children = _value_attributes(translator, value)
    return Element(tag, {"name": name, **attributes}, children)


def _value_attributes(
    translator: SubstitutionTranslator, value: av.Value
) -> tuple[dict[str, TemplateText], tuple[Element, ...]]:
    if isinstance(value, av.Choice):
        return {"value": translator.template(value)}, ()
    if isinstance(value, av.Instance) and launch_class_name(value) == "ParameterValue":
        fields = constructor_arguments(value)
        inner, children = _value_attributes(translator, fields.get("value", av.NONE))
        kind = fields.get("value_type", av.NONE)
        if isinstance(kind, (av.LibraryFunction, av.ExternalSymbol)) and kind.name == "str":
            return {"value": translator.template(fields.get("value")), "type": "str"}, ()
        return inner, children
    if isinstance(value, av.Scalar):
        type_attribute: dict[str, TemplateText] = (
            {"type": "str"} if isinstance(value.value, str) else {}
        )
        return {"value": (str(value.value),), **type_attribute}, ()
    if isinstance(value, av.ListValue) and not _is_one_text(value):
        return {"value": ("[]",)}, tuple(_item_element(translator, item) for item in value.items)
    return {"value": translator.template(value)}, ()


def _item_element(translator: SubstitutionTranslator, value: av.Value) -> Element:
    """Return an item of a list; a list in it is one text (launch_ros: normalize_parameters)."""
    if isinstance(value, av.ListValue):
        return Element("item", {"value": translator.template(value)})
    return Element("item", *_value_attributes(translator, value))


def _is_one_text(value: av.ListValue) -> bool:
    """Tell whether a list of strings and substitutions makes one string."""
    called = [launch_class_name(item) for item in value.items]
    plain = all(
        name or (isinstance(item, av.Scalar) and isinstance(item.value, str))
        for name, item in zip(called, value.items, strict=True)
    )
    return value.open or (any(called) and plain)
