"""The parts of an expression as functions in Python: operators, calls, and macros over lists."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import partial
from typing import Any

from rtron.messages.expressions.functions import BRACKETS, CLOSING, TOKEN
from rtron.messages.expressions.python_functions import EvaluationError
from rtron.messages.expressions.static_types import BOOL, StaticType, list_of

MAX_ROUNDS = 10_000
"""How many rounds all macros of one evaluation may take together."""


class BudgetError(Exception):
    """An evaluation takes too many rounds; nothing else in the expression makes up for that."""


@dataclass(slots=True)
class Scope:
    """The values of the variables, and how many rounds are left."""

    values: dict[str, Any]
    rounds: int = MAX_ROUNDS


Run = Callable[[Scope], Any]


@dataclass(frozen=True, slots=True)
class Term:
    """A part of an expression: its type, and what gives its value."""

    type: StaticType
    run: Run


def either(parts: Iterator[Callable[[], bool]], *, decisive: bool) -> bool:
    """Return `decisive` if a part is, also where another has no value; EvaluationError if unknown.

    `||` and `exists` for True, `&&` and `all` for False.
    """
    unknown: EvaluationError | None = None
    for part in parts:
        try:
            if part() is decisive:
                return decisive
        except EvaluationError as error:  # noqa: PERF203 - the others may decide
            unknown = unknown or error
    if unknown:
        raise unknown
    return not decisive


def junction(left: Term, right: Term, *, decisive: bool) -> Term:
    """Return `left || right` for a decisive True, `left && right` for False."""
    parts = left.run, right.run

    def run(scope: Scope) -> bool:
        return either((partial(part, scope) for part in parts), decisive=decisive)

    return Term(BOOL, run)


def choice(type: StaticType, condition: Term, one: Term, other: Term) -> Term:
    """Return `condition ? one : other`, of a type that both have."""
    test, yes, no = condition.run, one.run, other.run
    return Term(type, lambda scope: yes(scope) if test(scope) else no(scope))


def call(type: StaticType, function: Callable[..., Any], arguments: list[Term]) -> Term:
    """Return a call of a function."""
    runs = [each.run for each in arguments]
    return Term(type, lambda scope: function(*[run(scope) for run in runs]))


def item(values: Term, index: Term, element: StaticType) -> Term:
    """Return one of a list by its index."""

    def run(scope: Scope) -> Any:  # noqa: ANN401 - of the element's type
        found, at = values.run(scope), index.run(scope)
        if not 0 <= at < len(found):
            raise EvaluationError(f"Index error: index={at} size={len(found)}")
        return found[at]

    return Term(element, run)


def macro(name: str, values: Term, variable: str, body: Term) -> Term:
    """Return a macro over a list; `variable` stands for its elements in `body`."""

    def rounds(scope: Scope) -> Iterator[Any]:
        for each in values.run(scope):
            scope.rounds -= 1
            if scope.rounds < 0:
                raise BudgetError(f"its macros take more than {MAX_ROUNDS} rounds: over the budget")
            yield each

    def value(scope: Scope, each: Any) -> Any:  # noqa: ANN401 - of the body's type
        outer = scope.values.get(variable)
        scope.values[variable] = each
        try:
            return body.run(scope)
        finally:
            scope.values[variable] = outer

    return _MACROS[name](values, body, rounds, value)


_Rounds = Callable[[Scope], Iterator[Any]]
_Value = Callable[[Scope, Any], Any]


def _quantifier(decisive: bool) -> Callable[[Term, Term, _Rounds, _Value], Term]:  # noqa: FBT001
    def quantify(_values: Term, _body: Term, rounds: _Rounds, value: _Value) -> Term:
        def run(scope: Scope) -> bool:
            parts = (partial(value, scope, each) for each in rounds(scope))
            return either(parts, decisive=decisive)

        return Term(BOOL, run)

    return quantify


def _exists_one(_values: Term, _body: Term, rounds: _Rounds, value: _Value) -> Term:
    return Term(BOOL, lambda scope: sum([value(scope, each) for each in rounds(scope)]) == 1)


def _filter(values: Term, _body: Term, rounds: _Rounds, value: _Value) -> Term:
    return Term(values.type, lambda scope: [each for each in rounds(scope) if value(scope, each)])


def _map(_values: Term, body: Term, rounds: _Rounds, value: _Value) -> Term:
    return Term(list_of(body.type), lambda scope: [value(scope, each) for each in rounds(scope)])


_MACROS = {
    "exists": _quantifier(decisive=True),
    "all": _quantifier(decisive=False),
    "exists_one": _exists_one,
    "filter": _filter,
    "map": _map,
}
MACROS = frozenset(_MACROS)
"""The macros over lists."""


def macro_depth(text: str) -> int:
    """Return how deep the macros over lists in an expression are nested; 0 if there are none."""
    deepest, before, brackets = 0, "", [False]
    for word in (word for word in TOKEN.findall(text) if not word.isspace()):
        if word in BRACKETS:
            brackets.append(word == "(" and before in MACROS)
            deepest = max(deepest, sum(brackets))
        elif word in CLOSING and brackets:
            brackets.pop()
        before = word
    return deepest
