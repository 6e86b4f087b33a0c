"""`$(eval …)` as a closed grammar: literals, names, operators and a list of harmless functions.

roslaunch hands the text to Python's own eval; here it is parsed and walked, so that a launch file
cannot run anything. What lies outside the grammar is unresolvable, not an error: roslaunch may
well know it. Every value on the way is bounded (ROS wiki: roslaunch/XML, substitution args).
"""

import ast
from collections.abc import Callable, Mapping
from functools import lru_cache, partial, singledispatchmethod

from rtron.sources.launch.common.errors import UnresolvableError
from rtron.sources.launch.common.expression_library import (
    BINARY,
    COMPARE,
    CONSTANTS,
    FUNCTIONS,
    METHODS,
    UNARY,
    Function,
    Value,
    check_size,
)

_MAX_TEXT = 4096
_EVALUATION_ERRORS = (ArithmeticError, AttributeError, LookupError, TypeError, ValueError)


def evaluate(text: str, functions: Mapping[str, Function], argument: Callable[[str], Value]) -> str:
    """Return the value of an expression as a string.

    `functions` are those that the launch file's surroundings add (`arg`, `find`, …); `argument`
    gives a launch argument and raises KeyError. Raise ValueError if roslaunch could not evaluate
    it either, UnresolvableError if it lies outside the grammar.
    """
    return str(check_size(str(evaluate_with(ExpressionEvaluator(functions, argument), text))))


def evaluate_with(evaluator: "ExpressionEvaluator", text: str) -> Value:
    """Return the value of an expression in `evaluator`'s grammar; raise as `evaluate` does."""
    try:
        return evaluator.value(_parse(text))
    except _EVALUATION_ERRORS as error:
        raise ValueError(f"`{text[:80]}`: {error}") from None
    except RecursionError:
        raise UnresolvableError(f"`{text[:40]}…` is nested too deep") from None


def typed_argument(text: str) -> Value:
    """Return an argument as an expression sees it: a float, an int, a bool, or the string."""
    try:
        if "." in text:
            return float(text)
        if "_" not in text:
            return int(text)
    except ValueError:
        pass  # not a number: a truth value or a text
    return {"true": True, "false": False}.get(text.lower(), text)


@lru_cache(maxsize=1024)  # those of models come again for each node
def _parse(text: str) -> ast.expr:
    if "__" in text:
        raise ValueError("double underscores are not allowed")
    if len(text) > _MAX_TEXT:
        raise UnresolvableError(f"`{text[:40]}…` is too long")
    try:
        return ast.parse(text.strip(), mode="eval").body
    except (SyntaxError, MemoryError) as error:
        raise ValueError(str(error)) from None


class NodeMethod(singledispatchmethod):  # type: ignore[type-arg]
    """A method for each kind of a syntax tree's nodes, found in half the time of its base's."""

    def __get__(self, owner: object, kind: type | None = None) -> Callable[[ast.expr], Value]:
        """Return the method of an evaluator, which chooses by the node that it is given."""
        return lambda node: self.dispatcher.dispatch(type(node))(owner, node)


class ExpressionEvaluator:
    """Evaluates one parsed expression, a method a kind of node; a subclass may know more kinds."""

    def __init__(self, functions: Mapping[str, Function], argument: Callable[[str], Value]) -> None:
        self._functions: Mapping[str, Function] = {**FUNCTIONS, **functions}
        self._argument = argument

    def value(self, node: ast.expr) -> Value:
        """Return a node's value; raise UnresolvableError if it is outside the grammar or large."""
        return check_size(self._value(node))

    @NodeMethod
    def _value(self, node: ast.expr) -> Value:
        return self._unsupported(node)

    @_value.register
    def _(self, node: ast.Constant) -> Value:
        return node.value

    @_value.register
    def _(self, node: ast.Name) -> Value:
        return CONSTANTS[node.id] if node.id in CONSTANTS else self._argument(node.id)

    @_value.register
    def _(self, node: ast.List) -> Value:
        return [self.value(item) for item in node.elts]

    @_value.register
    def _(self, node: ast.Dict) -> Value:
        keys = [self.value(key) if key else self._unsupported(node) for key in node.keys]
        return dict(zip(keys, map(self.value, node.values), strict=True))

    @_value.register
    def _(self, node: ast.Tuple) -> Value:
        return tuple(self.value(item) for item in node.elts)

    @_value.register
    def _(self, node: ast.IfExp) -> Value:
        return self.value(node.body if self.value(node.test) else node.orelse)

    @_value.register
    def _(self, node: ast.BoolOp) -> Value:
        decisive = isinstance(node.op, ast.Or)
        for operand in node.values:
            result = self.value(operand)
            if bool(result) is decisive:
                break
        return result

    @_value.register
    def _(self, node: ast.BinOp) -> Value:
        function = BINARY.get(type(node.op)) or self._unsupported(node)
        return function(self.value(node.left), self.value(node.right))

    @_value.register
    def _(self, node: ast.UnaryOp) -> Value:
        return UNARY[type(node.op)](self.value(node.operand))

    @_value.register
    def _(self, node: ast.Compare) -> Value:
        left = self.value(node.left)
        for operation, comparator in zip(node.ops, node.comparators, strict=True):
            right = self.value(comparator)
            if not COMPARE[type(operation)](left, right):
                return False
            left = right
        return True

    @_value.register
    def _(self, node: ast.Subscript) -> Value:
        return self.value(node.value)[self._index(node.slice)]

    @_value.register
    def _(self, node: ast.Call) -> Value:
        function = self._function(node.func)
        if node.keywords:
            self._unsupported(node)
        return function(*(self.value(argument) for argument in node.args))

    def _function(self, node: ast.expr) -> Function:
        if isinstance(node, ast.Name) and node.id in self._functions:
            return self._functions[node.id]
        if isinstance(node, ast.Attribute) and node.attr in METHODS:
            owner = self.value(node.value)
            if isinstance(owner, str):
                return partial(METHODS[node.attr], owner)
        return self._unsupported(node)

    def _index(self, node: ast.expr) -> Value:
        if not isinstance(node, ast.Slice):
            return self.value(node)
        parts = (node.lower, node.upper, node.step)
        return slice(*(part and self.value(part) for part in parts))

    def _unsupported(self, node: ast.expr) -> Function:
        raise UnresolvableError(f"`{ast.unparse(node)}` is not of the kind that is evaluated here")
