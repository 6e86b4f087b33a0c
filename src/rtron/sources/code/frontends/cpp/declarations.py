"""Namespaces, classes, and what stands in them."""

from tree_sitter import Node

from rtron.sources.code.frontends.cpp.constants import integer
from rtron.sources.code.frontends.cpp.declarators import declarator
from rtron.sources.code.frontends.cpp.functions import add_function
from rtron.sources.code.frontends.cpp.lowering_context import Context, line_of
from rtron.sources.code.frontends.cpp.node_lowering import (
    declaration,
    declares,
    expression,
    expressions,
)
from rtron.sources.code.frontends.cpp.predefined_macros import ADAPTED, EXPORT
from rtron.sources.code.frontends.cpp.types import anonymous, named, spaced, type_of
from rtron.sources.code.frontends.cpp.variables import declared, variable
from rtron.sources.code.ir import Class, Declare, Evaluate, Stmt, TypeRef, adapted_name

_CLASSES = ("class_specifier", "struct_specifier", "union_specifier")
_TYPE_PARAMETERS = {
    "type_parameter_declaration",
    "optional_type_parameter_declaration",
    "variadic_type_parameter_declaration",
}
_NO_BASES = {"access_specifier", "virtual", "attribute_declaration"}


@declares("namespace_definition")
def _namespace(context: Context, node: Node, out: list[Stmt]) -> None:
    name, body = node.child_by_field_name("name"), node.child_by_field_name("body")
    full = context.qualified(context.text(name).replace(" ", "")) if name else context.scope
    with context.within(full):
        _members(context, body, out)


@declares("declaration_list", "ERROR")
def _list(context: Context, node: Node, out: list[Stmt]) -> None:
    _members(context, node, out)


def _members(context: Context, node: Node | None, out: list[Stmt]) -> None:
    for child in node.named_children if node else ():
        declaration(context, child, out)


@declares("linkage_specification")
def _linkage(context: Context, node: Node, out: list[Stmt]) -> None:
    body = node.child_by_field_name("body")
    if body is not None:
        declaration(context, body, out)


@declares("template_declaration")
def _template(context: Context, node: Node, out: list[Stmt]) -> None:
    parameters = node.child_by_field_name("parameters")
    found = parameters.named_children if parameters else []
    context.template = tuple(_template_parameter(context, child) for child in found)
    for child in node.named_children[1:]:
        declaration(context, child, out)
    context.template = ()


def _template_parameter(context: Context, node: Node) -> tuple[str, TypeRef | None]:
    """Return a parameter's name and default; that of a value is its text."""
    if node.type in _TYPE_PARAMETERS:
        name = node.child_by_field_name("name") or next(iter(node.named_children), None)
        default = type_of(context, node.child_by_field_name("default_type"))
        return (context.text(name) if name else ""), default
    name = node.child_by_field_name("declarator")
    value = node.child_by_field_name("default_value")
    return (context.text(name) if name else ""), TypeRef(context.text(value)) if value else None


@declares(*_CLASSES)
def _class(context: Context, node: Node, _out: list[Stmt]) -> None:
    name = node.child_by_field_name("name")
    add_class(context, node, named(context, name)[0] if name else anonymous(node))


def add_class(context: Context, node: Node, name: str) -> None:
    """Add a class under a name, and all that it declares, to the file's; not if it has no body."""
    body = node.child_by_field_name("body")
    if body is None:
        return
    fields: list[Stmt] = []
    full, template = context.qualified(name), context.take_template()
    bases = tuple(base for child in node.named_children for base in _bases(context, child))
    with context.within(full, in_class=True):
        _members(context, body, fields)
    context.classes.append(
        Class(
            name=full,
            file=context.file,
            line=line_of(node),
            bases=bases,
            fields=tuple(field for field in fields if isinstance(field, Declare)),
            template=template.names,
            defaults=template.defaults,
        )
    )


def _bases(context: Context, node: Node) -> list[TypeRef]:
    if node.type != "base_class_clause":
        return []
    found = [
        type_of(context, child) for child in node.named_children if child.type not in _NO_BASES
    ]
    return [base for base in found if base]


@declares("enum_specifier")
def _enum(context: Context, node: Node, _out: list[Stmt]) -> None:
    name = node.child_by_field_name("name")
    add_enum(context, node, named(context, name)[0] if name else "")


def add_enum(context: Context, node: Node, name: str) -> None:
    """Add the enumerators, each with and without the enum's name."""
    body, value = node.child_by_field_name("body"), -1
    known: int | None = value
    for child in body.named_children if body else ():
        given = child.child_by_field_name("value")
        label = child.child_by_field_name("name")
        if child.type != "enumerator" or label is None:
            continue
        known = (
            integer(context, expression(context, given))
            if given
            else None
            if known is None
            else known + 1
        )
        for prefix in {"", f"{name}::" if name else ""}:
            context.enums[context.qualified(prefix + context.text(label))] = known


@declares("type_definition")
def _typedef(context: Context, node: Node, out: list[Stmt]) -> None:
    type = node.child_by_field_name("type")
    names = [declarator(child) for child in node.children_by_field_name("declarator")]
    if type is None or not names or names[0].name is None:
        return
    if type.child_by_field_name("body") is not None:
        if type.child_by_field_name("name") is None:
            _name_anonymous(context, type, context.text(names[0].name))
            return
        declaration(context, type, out)
    for found in names:
        written = TypeRef(spaced(context, node)) if found.function else type_of(context, type)
        target = found.typed(context, written)
        if found.name is not None and target is not None:
            context.aliases.append((context.qualified(context.text(found.name)), target))


def _name_anonymous(context: Context, node: Node, name: str) -> None:
    if node.type == "enum_specifier":
        add_enum(context, node, name)
    else:
        add_class(context, node, name)


@declares("alias_declaration")
def _alias(context: Context, node: Node, _out: list[Stmt]) -> None:
    name = context.text(node.child_by_field_name("name") or node)
    target = type_of(context, node.child_by_field_name("type"))
    context.template = ()
    if target is None:
        return
    if name == EXPORT:
        _export(context, target)
    elif name == ADAPTED and len(target.args) == 2:  # noqa: PLR2004 - the type and its message
        custom, message = target.args
        context.aliases.append((adapted_name(str(custom)), message))
    else:
        context.aliases.append((context.qualified(name), target))


def _export(context: Context, target: TypeRef) -> None:
    names = [str(arg).removeprefix("::") for arg in target.args]
    if names:
        exported = names[0] if "::" in names[0] else context.qualified(names[0])
        context.exports.append((exported, names[1] if names[1:] else ""))


@declares("namespace_alias_definition")
def _namespace_alias(context: Context, node: Node, _out: list[Stmt]) -> None:
    name, *target = node.named_children
    if target:
        alias = TypeRef(context.text(target[0]).replace(" ", "").removeprefix("::"))
        context.aliases.append((context.qualified(context.text(name)), alias))


@declares("using_declaration")
def _using(context: Context, node: Node, _out: list[Stmt]) -> None:
    for child in node.named_children[-1:]:
        context.usings.append(named(context, child)[0])


@declares("expression_statement")
def _stray(context: Context, node: Node, out: list[Stmt]) -> None:
    """Keep a call that stands outside of all functions, as in a file with a brace too many."""
    if not context.in_class:
        values = expressions(context, node.named_children)
        out.extend(Evaluate(value, line_of(node)) for value in values)


@declares("declaration", "field_declaration")
def _declaration(context: Context, node: Node, out: list[Stmt]) -> None:
    type = node.child_by_field_name("type")
    if type is not None and type.child_by_field_name("body") is not None:
        _declared_type(context, node, type, out)
    if any(
        context.text(c) == "extern" for c in node.named_children if c.type.startswith("storage")
    ):
        return
    for one in declared(node):
        found = one.declarator
        if found.function is not None or found.name is None or found.name.type == "operator_cast":
            add_function(context, node, found)
        else:
            name = named(context, found.name)[0]
            full = name if context.in_class else context.qualified(name)
            out.append(variable(context, node, one, full))


def _declared_type(context: Context, node: Node, type: Node, out: list[Stmt]) -> None:
    """Declare the type that a declaration defines; one without a name and variable is dissolved."""
    plain = node.child_by_field_name("declarator") is None
    if (
        plain
        and context.in_class
        and type.type in _CLASSES
        and not type.child_by_field_name("name")
    ):
        _members(context, type.child_by_field_name("body"), out)
    else:
        declaration(context, type, out)
