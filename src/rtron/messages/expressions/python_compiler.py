"""Expressions where Google's CEL is not to be had: cel-python's parser behind our own type check.

cel-python checks no types, bounds no loops and copies all variables for each round of one. So only
its parser is used: each part of its tree gets a type, by which it becomes a function in Python.
What plans need of CEL is there, with the same values; the rest (maps, timestamps, unsigned numbers,
`dyn`, new messages) is refused. Property tests compare the two.
"""

from __future__ import annotations

import operator
from typing import TYPE_CHECKING, Any

from rtron.messages.expressions import python_functions as functions
from rtron.messages.expressions.errors import CheckError
from rtron.messages.expressions.frames import is_point
from rtron.messages.expressions.functions import RESERVED
from rtron.messages.expressions.python_literals import (
    argument_nodes,
    bracket_count,
    literal_value,
    parse,
    unwrapped,
    variable_name,
)
from rtron.messages.expressions.python_terms import (
    MACROS,
    Scope,
    Term,
    call,
    choice,
    item,
    junction,
    macro,
)
from rtron.messages.expressions.static_types import (
    AREA_TYPE,
    BOOL,
    BYTES,
    DOUBLE,
    INT,
    STRING,
    StaticType,
    field_type,
    list_of,
)

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from lark import Token, Tree

    from rtron.messages.expressions.python_functions import Function
    from rtron.vocabulary import Area

    Node = Tree[Token] | Token

_MAX_DEPTH = 64
_OPERATORS = {
    "relation_lt": "<",
    "relation_le": "<=",
    "relation_gt": ">",
    "relation_ge": ">=",
    "relation_eq": "==",
    "relation_ne": "!=",
    "relation_in": "in",
    "addition_add": "+",
    "addition_sub": "-",
    "multiplication_mul": "*",
    "multiplication_div": "/",
    "multiplication_mod": "%",
}
_ACCUMULATOR = "__result__"  # what CEL calls the result of a macro in its body
_EXTREMES = {"math.greatest": max, "math.least": min}
_LITERALS = {"BOOL_LIT": BOOL, "INT_LIT": INT, "FLOAT_LIT": DOUBLE, "BYTES_LIT": BYTES}


class PythonCompiler:
    """Compiles expressions over variables, each of its type; `point` is what `place` makes."""

    def __init__(self, variables: Mapping[str, StaticType], point: StaticType) -> None:
        self._variables = dict(variables)
        self._areas = frozenset(name for name, type in variables.items() if type == AREA_TYPE)
        self._point = point
        self._depth = 0

    def compile(self, text: str) -> tuple[str, Callable[[Any], Any]]:
        """Return the type of an expression, and what evaluates it.

        CheckError if it is none, or not one that works here.
        """
        self._depth = 0
        term = self._term(parse(text))
        type = term.type.name
        return type.upper() if "." not in type else type, lambda values: term.run(Scope(values))

    def activate(self, values: Mapping[str, Any]) -> dict[str, Any]:
        """Return what expressions over these values are evaluated with."""
        return dict(values)

    def area(self, _make: Any, area: Area) -> functions.AreaShape:  # noqa: ANN401
        """Return an area as a value."""
        return functions.AreaShape(area)

    def _term(self, part: Node) -> Term:
        node, outer = unwrapped(part), self._depth
        self._depth += 1 + bracket_count(part)
        if self._depth > _MAX_DEPTH:
            what = f"more than {_MAX_DEPTH} levels: the recursion limit is exceeded"
            raise CheckError(f"ERROR: <input>:-1:-1: {what}")
        kind = str(node.data)
        compile_node = getattr(self, f"_{kind}", None)
        if compile_node is None:
            raise _error(node, _not_here(kind.replace("_", " ")))
        found: Term = compile_node(node, *node.children)
        self._depth = outer
        return found

    def _expr(self, tree: Any, *parts: Node) -> Term:  # noqa: ANN401 - lark's
        condition, one, other = map(self._term, parts)
        type = one.type.joined(other.type)
        if condition.type != BOOL or type is None:
            raise _mismatch(tree, "_?_:_", condition, one, other)
        return choice(type, condition, one, other)

    def _conditionalor(self, tree: Any, *parts: Node) -> Term:  # noqa: ANN401
        return self._junction(tree, "_||_", *parts)

    def _conditionaland(self, tree: Any, *parts: Node) -> Term:  # noqa: ANN401
        return self._junction(tree, "_&&_", *parts)

    def _junction(self, tree: Any, name: str, *parts: Node) -> Term:  # noqa: ANN401
        left, right = map(self._term, parts)
        if (left.type, right.type) != (BOOL, BOOL):
            raise _mismatch(tree, name, left, right)
        return junction(left, right, decisive=name == "_||_")

    def _relation(self, _: Any, relation: Any, right_node: Node) -> Term:  # noqa: ANN401
        left, right = self._term(relation.children[0]), self._term(right_node)
        name = _OPERATORS[relation.data]
        compare = _relation_function(name, left.type, right.type)
        if not left.type.is_plain:
            raise _error(relation, _not_here(f"comparing values of {left.type}"))
        if compare is None:
            raise _operator_mismatch(relation, name, left, right)
        return call(BOOL, compare, [left, right])

    def _addition(self, _: Any, operation: Any, right_node: Node) -> Term:  # noqa: ANN401
        left, right = self._term(operation.children[0]), self._term(right_node)
        name = _OPERATORS[operation.data]
        compute = functions.ARITHMETIC[name].get(left.type) if left.type == right.type else None
        if name == "+" and left.type.is_list and left.type.matches(right.type):
            raise _error(operation, _not_here("+ of lists"))
        if compute is None:
            raise _operator_mismatch(operation, name, left, right)
        return call(left.type, compute, [left, right])

    _multiplication = _addition

    def _unary(self, tree: Any, sign: Any, operand_node: Node) -> Term:  # noqa: ANN401
        operand = self._term(operand_node)
        if sign.data == "unary_not" and operand.type == BOOL:
            return call(BOOL, operator.not_, [operand])
        negate = functions.NEGATION.get(operand.type) if sign.data == "unary_neg" else None
        if negate is None:
            raise _mismatch(tree, "!_" if sign.data == "unary_not" else "-_", operand)
        return call(operand.type, negate, [operand])

    def _ident(self, _: Any, name: Token) -> Term:  # noqa: ANN401
        type = self._variables.get(str(name))
        if type is None:
            raise _error(name, f"undeclared reference to '{name}'")
        variable = str(name)
        return Term(type, lambda scope: scope.values[variable])

    def _dot_ident(self, tree: Any, *_: Any) -> Term:  # noqa: ANN401
        raise _error(tree, _not_here("a name after a dot alone"))

    _dot_ident_arg = _dot_ident

    def _member_dot(self, _: Any, owner_node: Node, name: Token) -> Term:  # noqa: ANN401
        owner = self._term(owner_node)
        type, read = self._field(owner, name), operator.attrgetter(str(name))
        return call(type, (lambda message: list(read(message))) if type.is_list else read, [owner])

    def _field(self, owner: Term, name: Token) -> StaticType:
        if owner.type.definition is None:
            raise _error(
                name, f"expression of type '{owner.type}' does not support field selection"
            )
        found = field_type(owner.type, str(name))
        if found is None:
            raise _error(name, f"undefined field '{name}' not found in struct '{owner.type}'", 1)
        return found

    def _member_index(self, tree: Any, *parts: Node) -> Term:  # noqa: ANN401
        values, index = map(self._term, parts)
        if values.type.is_list and not values.type.is_known:
            raise _error(tree, _not_here(f"an element of {values.type}"))
        if not values.type.element or index.type != INT:
            raise _mismatch(tree, "_[_]", values, index)
        return item(values, index, values.type.element)

    def _list_lit(self, tree: Any, *parts: Any) -> Term:  # noqa: ANN401
        elements = [self._term(each) for each in argument_nodes(parts)]
        type = elements[0].type if elements else None
        for each in elements:
            type = type and type.joined(each.type)
        if elements and type is None:
            raise _error(tree, _not_here("a list of several types"))
        return call(list_of(type), lambda *values: list(values), elements)

    def _literal(self, tree: Any, token: Token) -> Term:  # noqa: ANN401
        kind = str(token.type)
        if kind in ("UINT_LIT", "NULL_LIT"):
            raise _error(tree, _not_here(str(token)))
        try:
            value = literal_value(kind, str(token))
        except ValueError as error:
            raise _error(token, str(error)) from error
        return Term(_LITERALS.get(kind, STRING), lambda _: value)

    def _ident_arg(self, tree: Any, name: Token, *rest: Any) -> Term:  # noqa: ANN401
        arguments = argument_nodes(rest)
        if name == "has":
            return self._has(tree, arguments)
        terms = [self._term(each) for each in arguments]
        types = tuple(each.type for each in terms)
        known = _function(str(name), types) or self._place_function(name, types, arguments)
        return _call(tree, str(name), known, terms)

    def _member_dot_arg(self, tree: Any, owner: Node, name: Token, *rest: Any) -> Term:  # noqa: ANN401
        arguments = argument_nodes(rest)
        if variable_name(owner) == "math" and "math" not in self._variables:
            terms = [self._term(each) for each in arguments]
            known = _function(f"math.{name}", tuple(each.type for each in terms))
            return _call(tree, f"math.{name}", known, terms)
        values = self._term(owner)
        if name in MACROS and arguments:
            return self._macro(tree, str(name), values, arguments)
        terms = [values, *map(self._term, arguments)]
        known = _method(name, tuple(each.type for each in terms))
        if known is None:
            raise _mismatch(tree, str(name), *terms)
        return call(*known, terms)

    def _macro(self, tree: Any, name: str, values: Term, arguments: list[Any]) -> Term:  # noqa: ANN401
        variable = variable_name(arguments[0])
        if len(arguments) != 2 or not variable:  # noqa: PLR2004 - a variable and a body
            raise _error(tree, _not_here(f"{name}() with other than a variable and a body"))
        if variable in RESERVED or variable == _ACCUMULATOR:
            raise _error(arguments[0], f"reserved identifier: {variable}")
        if not values.type.element or not values.type.is_known:
            raise _error(tree, _not_here(f"{name}() of {values.type}"))
        outer, self._variables = self._variables, {**self._variables, variable: values.type.element}
        try:
            body = self._term(arguments[1])
        finally:
            self._variables = outer
        if name != "map" and body.type != BOOL:
            raise _error(tree, f"the body of {name}() gives {body.type}, not a truth")
        return macro(name, values, variable, body)

    def _has(self, tree: Any, arguments: list[Any]) -> Term:  # noqa: ANN401
        """Return whether a field is there: each one is, a list if it is not empty."""
        selected = unwrapped(arguments[0]) if len(arguments) == 1 else tree
        if selected.data != "member_dot":
            raise _error(tree, "invalid argument to has() macro")
        found = self._term(selected)
        return call(BOOL, bool if found.type.is_list else lambda _: True, [found])

    def _place_function(
        self, name: str, types: tuple[StaticType, ...], nodes: list[Any]
    ) -> tuple[StaticType, Function] | None:
        if name == "place" and types == (DOUBLE, DOUBLE):
            return self._point, functions.place
        if len(types) != 2 or not _is_point(types[0]):  # noqa: PLR2004
            return None
        if name == "inside" and types[1] == AREA_TYPE:
            return BOOL, functions.inside
        is_area = variable_name(nodes[1]) in self._areas and not bracket_count(nodes[1])
        if name == "distance" and is_area and types[1] == AREA_TYPE:
            return DOUBLE, functions.distance_to_area
        if name == "distance" and not is_area and _is_point(types[1]):
            return DOUBLE, functions.distance_to_point
        return None


def _relation_function(name: str, left: StaticType, right: StaticType) -> Function | None:
    if name == "in":
        is_known = right.is_list and list_of(left).matches(right) and left.is_plain
        return functions.is_in if is_known else None
    if not left.matches(right) or not left.is_plain:
        return None
    return functions.EQUALITY.get(name) or (None if left.is_list else functions.ORDER.get(name))


def _function(name: str, types: tuple[StaticType, ...]) -> tuple[StaticType, Function] | None:
    return functions.FUNCTIONS_OF_TYPES.get((name, types)) or _list_function(name, types)


def _method(name: str, types: tuple[StaticType, ...]) -> tuple[StaticType, Function] | None:
    """Return what is called on the first of the types."""
    return functions.METHODS_OF_TYPES.get((name, types)) or (
        _list_function(name, types) if name == "size" else None
    )


def _call(
    tree: Any,  # noqa: ANN401 - lark's
    name: str,
    known: tuple[StaticType, Function] | None,
    terms: list[Term],
) -> Term:
    """Return a call of a function that is no method."""
    if known is not None:
        return call(*known, terms)
    if functions.is_elsewhere(name, tuple(each.type for each in terms)):
        raise _error(tree, _not_here(f"{name}({', '.join(str(each.type) for each in terms)})"))
    raise _mismatch(tree, name, *terms)


def _list_function(name: str, types: tuple[StaticType, ...]) -> tuple[StaticType, Function] | None:
    """Return the functions that take lists, or any number of arguments."""
    if name == "size" and len(types) == 1 and types[0].is_list:
        return INT, len
    numbers = types[0].element if len(types) == 1 and types[0].is_list else None
    single = types[0] if types and set(types) == {types[0]} else None
    if name not in _EXTREMES or (numbers or single) not in (INT, DOUBLE):
        return None
    choose = functions.extreme(_EXTREMES[name])
    return (numbers, lambda values: choose(*values)) if numbers else (types[0], choose)


def _is_point(type: StaticType) -> bool:
    return type.definition is not None and is_point(type.definition)


def _error(node: Any, what: str, before: int = 0) -> CheckError:  # noqa: ANN401
    place = getattr(node, "meta", node)
    line, column = getattr(place, "line", 1) or 1, (getattr(place, "column", 1) or 1) - before
    return CheckError(f"ERROR: <input>:{line}:{column}: {what}")


def _operator_mismatch(node: Any, name: str, *terms: Term) -> CheckError:  # noqa: ANN401
    types = ", ".join(str(each.type) for each in terms)
    what = f"found no matching overload for '_{name}_' applied to '({types})'"
    column = node.meta.end_column - len(name)
    return CheckError(f"ERROR: <input>:{node.meta.end_line}:{column}: {what}")


def _mismatch(node: Any, name: str, *terms: Term) -> CheckError:  # noqa: ANN401
    types = ", ".join(str(each.type) for each in terms)
    return _error(node, f"found no matching overload for '{name}' applied to '({types})'")


def _not_here(what: str) -> str:
    return f"{what} needs the package cel-expr-python, which has no wheel for this machine"
