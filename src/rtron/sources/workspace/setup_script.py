"""What a setup.py gives to `setup()`: read statement by statement, never run (setuptools).

Known are texts, lists, dicts, and loops over them; whatever else there is, is unknown. In a text
HOLE stands for it.
"""

import ast
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import TypeAlias

SetupValue: TypeAlias = "str | list[SetupValue] | dict[str, SetupValue] | None"
"""A text, a list or a dict; None for what is not known."""

HOLE = "\0"
MAX_STEPS = 20_000
_MAX_DEPTH = 32
_SETUP_CALLS = frozenset({"generate_distutils_setup", "setup", "dict"})


class _StepsExceededError(Exception):
    """A setup.py takes too many steps."""


@dataclass(slots=True)
class SetupScript:
    """The arguments of the calls of `setup()`, by name, with the line of each."""

    arguments: dict[str, tuple[SetupValue, int]] = field(default_factory=dict)
    is_complete: bool = True
    _variables: dict[str, SetupValue] = field(default_factory=dict)
    _steps: int = 0

    def read(self, tree: ast.Module) -> None:
        """Read a setup.py; it is not complete where that takes too many steps."""
        try:
            self._statements(tree.body, 0)
        except (_StepsExceededError, RecursionError):
            self.is_complete = False

    def _statements(self, body: Sequence[ast.stmt], depth: int) -> None:
        for statement in body if depth < _MAX_DEPTH else ():
            self._step()
            if isinstance(statement, ast.For):
                self._for(statement, depth)
                continue
            self._assign(statement)
            for call in _calls(statement):
                self._call(call)
            for block in ("body", "handlers", "orelse", "finalbody"):
                self._statements(getattr(statement, block, ()), depth + 1)

    def _for(self, loop: ast.For, depth: int) -> None:
        for item in self._items(self._value(loop.iter)):
            self._bind(loop.target, item)
            self._statements(loop.body, depth + 1)

    def _assign(self, statement: ast.stmt) -> None:
        if isinstance(statement, ast.Assign):
            value = self._value(statement.value)
            for target in statement.targets:
                self._bind(target, value)
        elif isinstance(statement, ast.AugAssign) and isinstance(statement.target, ast.Name):
            name = statement.target.id
            added = self._add(self._variables.get(name), self._value(statement.value))
            self._variables[name] = added

    def _bind(self, target: ast.expr, value: SetupValue) -> None:
        if isinstance(target, ast.Name):
            self._variables[target.id] = value
        elif isinstance(target, ast.Tuple):
            parts = value if isinstance(value, list) else []
            for name, part in zip(target.elts, [*parts, *[None] * len(target.elts)], strict=False):
                self._bind(name, part)
        elif isinstance(target, ast.Subscript):
            owner, key = self._value(target.value), self._value(target.slice)
            if isinstance(owner, dict) and isinstance(key, str):
                owner[key] = value

    def _call(self, call: ast.Call) -> None:
        """Take the arguments of `setup()`, or what is appended to a list."""
        function = call.func
        if isinstance(function, ast.Attribute) and function.attr in {"append", "extend"}:
            owner = self._value(function.value)
            added = self._value(call.args[0]) if call.args else None
            if isinstance(owner, list):
                owner.extend(self._items(added) if function.attr == "extend" else [added])
        elif getattr(function, "id", getattr(function, "attr", "")) in _SETUP_CALLS:
            for word in call.keywords:
                value = self._value(word.value)
                given = value if word.arg is None and isinstance(value, dict) else {}
                given = given if word.arg is None else {word.arg: value}
                self.arguments.update((name, (each, call.lineno)) for name, each in given.items())

    def _value(self, node: ast.expr, depth: int = 0) -> SetupValue:
        self._step()
        evaluate = getattr(self, _EVALUATORS.get(type(node), "_unknown"))
        found: SetupValue = evaluate(node, depth + 1) if depth < _MAX_DEPTH else None
        return found

    def _unknown(self, _: ast.expr, __: int) -> SetupValue:
        return None

    def _constant(self, node: ast.Constant, _: int) -> SetupValue:
        return str(node.value) if isinstance(node.value, (str, int)) else None

    def _name(self, node: ast.Name, _: int) -> SetupValue:
        return self._variables.get(node.id)

    def _list(self, node: ast.List | ast.Tuple | ast.Set, depth: int) -> SetupValue:
        found: list[SetupValue] = []
        for item in node.elts:
            if isinstance(item, ast.Starred):
                found += self._items(self._value(item.value, depth))
            else:
                found.append(self._value(item, depth))
        return found

    def _dict(self, node: ast.Dict, depth: int) -> SetupValue:
        found: dict[str, SetupValue] = {}
        for key, value in zip(node.keys, node.values, strict=True):
            name = self._value(key, depth) if key is not None else None
            if isinstance(name, str):
                found[name] = self._value(value, depth)
        return found

    def _item(self, node: ast.Subscript, depth: int) -> SetupValue:
        owner, key = self._value(node.value, depth), self._value(node.slice, depth)
        return owner.get(key) if isinstance(owner, dict) and isinstance(key, str) else None

    def _sum(self, node: ast.BinOp, depth: int) -> SetupValue:
        left, right = self._value(node.left, depth), self._value(node.right, depth)
        if isinstance(node.op, ast.Mod) and isinstance(left, str):
            return self._fill(left, "%s", right if isinstance(right, list) else [right])
        return self._add(left, right) if isinstance(node.op, ast.Add) else None

    def _format(self, node: ast.JoinedStr, depth: int) -> SetupValue:
        return "".join(self._text(self._value(part, depth)) for part in node.values)

    def _formatted(self, node: ast.FormattedValue, depth: int) -> SetupValue:
        return self._value(node.value, depth)

    def _method(self, node: ast.Call, depth: int) -> SetupValue:
        """Return what `dict(…)`, `list(…)`, `sorted(…)` and `"…".format(…)` give."""
        given = [self._value(argument, depth) for argument in node.args]
        function = node.func
        if isinstance(function, ast.Attribute) and function.attr == "format":
            text = self._value(function.value, depth)
            return self._fill(text, "{}", given) if isinstance(text, str) else None
        name = getattr(function, "id", "")
        if name == "dict" and not given:
            return {w.arg: self._value(w.value, depth) for w in node.keywords if w.arg}
        is_copy = name in {"list", "sorted", "tuple", "set"} and bool(given)
        return self._items(given[0]) if is_copy else None

    def _comprehension(self, node: ast.ListComp | ast.GeneratorExp, depth: int) -> SetupValue:
        found: list[SetupValue] = []
        before = dict(self._variables)
        self._generate(node.generators, node.elt, found, depth)
        self._variables = before
        return found

    def _generate(
        self,
        generators: Sequence[ast.comprehension],
        made: ast.expr,
        found: list[SetupValue],
        depth: int,
    ) -> None:
        """Add what a comprehension makes; what a condition leaves out, too."""
        if not generators:
            found.append(self._value(made, depth))
            return
        for item in self._items(self._value(generators[0].iter, depth)):
            self._bind(generators[0].target, item)
            self._generate(generators[1:], made, found, depth)

    def _fill(self, text: str, hole: str, given: Sequence[SetupValue]) -> str:
        for value in given:
            self._step(len(text))
            text = text.replace(hole, self._text(value), 1)
        return text

    def _add(self, left: SetupValue, right: SetupValue) -> SetupValue:
        if isinstance(left, list) or isinstance(right, list):
            return [*self._items(left), *self._items(right)]
        is_text = isinstance(left, str) or isinstance(right, str)
        return self._text(left) + self._text(right) if is_text else None

    def _items(self, value: SetupValue) -> list[SetupValue]:
        """Return what a loop goes through: once through nothing known, where that is not known."""
        found: list[SetupValue] = list(value) if isinstance(value, (list, dict)) else [None]
        self._step(64 * len(found))
        return found

    def _text(self, value: SetupValue) -> str:
        text = value if isinstance(value, str) else HOLE
        self._step(len(text))
        return text

    def _step(self, size: int = 0) -> None:
        self._steps += 1 + size // 64
        if self._steps > MAX_STEPS:
            raise _StepsExceededError


def is_known(value: SetupValue) -> bool:
    """Tell whether all of a value is known."""
    if isinstance(value, (list, dict)):
        return all(map(is_known, value.values() if isinstance(value, dict) else value))
    return value is not None and HOLE not in value


def _calls(statement: ast.stmt) -> Iterator[ast.Call]:
    """Return the call that a statement is, or whose result it keeps."""
    value = getattr(statement, "value", None)
    if isinstance(value, ast.Call):
        yield value


_EVALUATORS: Mapping[type[ast.expr], str] = {
    ast.Constant: "_constant",
    ast.Name: "_name",
    **dict.fromkeys((ast.List, ast.Tuple, ast.Set), "_list"),
    ast.Dict: "_dict",
    ast.Subscript: "_item",
    ast.BinOp: "_sum",
    ast.JoinedStr: "_format",
    ast.FormattedValue: "_formatted",
    ast.Call: "_method",
    **dict.fromkeys((ast.ListComp, ast.GeneratorExp, ast.SetComp), "_comprehension"),
}
