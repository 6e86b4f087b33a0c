"""What becomes of the last message of a topic when no more come, as far as the code tells.

A callback keeps the time at which a message came, and what runs besides compares that with now; or
it keeps the message alone, and what runs besides goes on with it.
"""

import re
import sys
from collections.abc import Collection, Iterable, Iterator
from dataclasses import dataclass, field, replace
from functools import cached_property
from itertools import islice

from rtron.sources.code.function_steps import (
    RESULT,
    SELF,
    FunctionSteps,
    Test,
    assignments,
    is_comparison,
    is_log,
    is_logger,
    is_stop,
    is_zero,
    last_name,
    mentioned_names,
)
from rtron.sources.code.interpreter.abstract_values.value_types import Instance
from rtron.sources.code.interpreter.execution.abstract_machine import AbstractMachine
from rtron.sources.code.ir import Assign, Binary, Call, Const, Evaluate, Expr, Function, New
from rtron.sources.code.ir.references import ir_nodes
from rtron.sources.code.reachability import methods, reachable_functions, unknown_bases
from rtron.sources.code.repeated_message import (
    dependent_nodes,
    find_outputs,
    find_repetition,
    is_cleared_by,
    is_compared,
    is_counted,
    made_of,
)
from rtron.sources.code.watchdogs import (
    CLOCKS,
    clock_functions,
    has_timed_wait,
    is_time,
    may_be_watched,
)
from rtron.sources.declaration import Declaration, DeclarationKind, LastMessageUse
from rtron.vocabulary import Evidence, LastMessageFate

_STATES = re.compile(
    r"sensor_msgs/(?!(?:msg/)?Joy)|nav_msgs/|tf2?_msgs/|visualization_msgs/|diagnostic_msgs/"
    r"|rosgraph_msgs/|rcl_interfaces/"
)
"""Types of what is measured or shown: no command."""
_ORDERS = re.compile(r"cmd|command|target|desired|goal|set_?point|reference", re.IGNORECASE)
"""Words in the names of topics that command, also where their type tells what was measured."""
_STEERING = re.compile(r"steer|angle|servo", re.IGNORECASE)
"""Words in the names of values that move no vehicle whose speed is zero."""
_HEADERS = (".h", ".hh", ".hpp", ".hxx", ".inl")
_STANDARD = frozenset({"object", *sys.stdlib_module_names})
"""Where classes are from that know nothing of messages."""
_MAX_FUNCTIONS = 1000
_MAX_REACHED = 100


def last_messages(machine: AbstractMachine) -> Iterator[LastMessageUse]:
    """Yield what becomes of the last message of each subscription whose callback is known."""
    program = _Program(machine)
    for declared in machine.recorder.declared(DeclarationKind.SUBSCRIBE):
        given = (f for at in declared.evidence for f in machine.callbacks_at.get(at, ()))
        callbacks = {each.key: each for each in given if _takes_message(each)}.values()
        if callbacks and not _STATES.match(declared.type):
            uses = [program.fate(declared.evidence[0], [each]) for each in callbacks]
            is_one = len({use.fate for use in uses}) == 1  # else: which is whose, on one line
            yield uses[0] if is_one else replace(uses[0], fate=LastMessageFate.CHECKED)


def _takes_message(callback: Function) -> bool:
    return any(param.name != "self" for param in callback.params)


@dataclass
class _Program:
    """The functions of a program, and how they use what a callback keeps."""

    machine: AbstractMachine
    _known: dict[int, FunctionSteps] = field(default_factory=dict)

    @cached_property
    def codes(self) -> list[FunctionSteps]:
        """What all functions of the program do."""
        functions = {f.key: f for _, f in self.machine.runtime.program_functions()}
        functions |= {f.key: f for given in self.machine.callbacks_at.values() for f in given}
        functions |= {each.key: each for each in self.machine.module_loops}
        return [self._code(each) for each in _sources_first(functions.values(), _MAX_FUNCTIONS)]

    @cached_property
    def _clocks(self) -> frozenset[str]:
        """The names of the program's own functions that tell the time."""
        return clock_functions(f for _, f in self.machine.runtime.program_functions())

    def fate(self, place: Evidence, callbacks: list[Function]) -> LastMessageUse:
        """Return what becomes of the last message that a subscription's callbacks got."""
        reached = self._reached(callbacks)
        keys = {each.function.key for each in reached}
        others = [each for each in self.codes if each.function.key not in keys]
        beside = self._run_beside(callbacks)
        stored = {
            name for each in reached for name, value in each.members if _is_given(value, each)
        }
        times = {name for each in reached for name, value in each.members if is_time(value, each)}
        times |= {name for each in beside for name in _times_of_taking(each, stored)}
        stored -= times
        if found := self._age_test(times, beside, stored):
            return replace(found, evidence=(place, *found.evidence))
        if found := self._age_test(times, others, stored):  # who calls them is not known
            evidence = (place, *found.evidence)
            return replace(found, fate=LastMessageFate.CHECKED, evidence=evidence)
        is_watched = may_be_watched(reached, others) or self._may_base_watch(callbacks)
        is_watched |= any(_tests_stamp(each, stored) for each in others)
        if is_watched or self._is_marked(reached, others):
            return LastMessageUse(fate=LastMessageFate.CHECKED, evidence=(place,))
        repetition = find_repetition(stored, reached, beside)
        made = dict(self._publishers_made(repetition.publishers))
        fate = LastMessageFate.REPEATED
        is_noticed = is_counted(reached, others) or is_compared(stored, others)
        if repetition.is_cleared or is_noticed or has_timed_wait(reached, others):
            fate = LastMessageFate.CHECKED
        elif not repetition.publishers or (made and all(map(_is_state, made.values()))):
            fate = LastMessageFate.UNNOTICED
        further = made if fate is LastMessageFate.REPEATED else ()
        return LastMessageUse(fate=fate, evidence=(place, *further))

    def _publishers_made(self, names: Collection[str]) -> Iterator[tuple[Evidence, Declaration]]:
        """Yield the publishers that variables or members hold by where they are made, if known."""
        published = self.machine.recorder.declared(DeclarationKind.PUBLISH)
        made = {at: declared for declared in published for at in declared.evidence}
        found = dict[Evidence, None]()
        for code in self.codes:
            given = (*code.members, *code.locals, *code.function.initialisers)
            values = [value for name, value in given if name in names]
            lines = {n.line for n in ir_nodes(tuple(values)) if isinstance(n, (Call, New))}
            found |= dict.fromkeys(Evidence(file=code.function.file, line=n) for n in sorted(lines))
        yield from ((at, made[at]) for at in found if at in made)

    def _run_beside(self, callbacks: list[Function]) -> list[FunctionSteps]:
        """Return what runs without the message: other callbacks, and loops with what they call."""
        own = {each.key for each in callbacks}
        given = (each for many in self.machine.callbacks_at.values() for each in many)
        looping = [each for each in self.codes if each.loop_calls and each.function.key not in own]
        called = {name for each in looping for name in each.loop_calls}
        roots = [each for each in given if each.key not in own]
        roots += [f for name in called for f in self.machine.runtime.functions_named(name)]
        return [*looping, *self._reached(each for each in roots if each.key not in own)]

    def _age_test(
        self, times: set[str], codes: list[FunctionSteps], stored: set[str]
    ) -> LastMessageUse | None:
        """Return the first test of a time that was stored, rather one that stops something."""
        found: LastMessageUse | None = None
        outputs = find_outputs(self.codes, stored) if times else frozenset()
        verdicts = {
            each.function.name.rpartition("::")[2]
            for each in codes
            if _returns_verdict(each, times)
        }
        for code in codes if times else ():
            names, flags = _aliases(code, times)
            for test in code.tests:
                if not _is_about(test.condition, names, flags | verdicts):
                    continue
                at = Evidence(file=code.function.file, line=test.line or code.function.line)
                stops = self._stops(code, test, stored, outputs)
                fate = LastMessageFate.STOPPED if stops else LastMessageFate.CHECKED
                seconds = _limit(test.condition, names)
                if found is None or stops:
                    found = LastMessageUse(fate=fate, seconds=seconds, evidence=(at,))
                if stops:
                    return found
        return found

    def _stops(
        self, code: FunctionSteps, test: Test, stored: set[str], outputs: frozenset[str]
    ) -> bool:
        """Return whether what depends on a test, or what it leaves at zero, stops something."""
        sent = _sent_names(code, stored)
        in_branches = list(ir_nodes(test.branches))
        sent -= _zeroed_in_part(in_branches, stored, self.codes)
        zeros = {name for name, value in (*code.locals, *code.members) if is_zero(value)} & sent
        steps = [n for n in in_branches if isinstance(n, (Assign, Evaluate))]
        for node in steps:
            left_at_zero = any(last_name(t) in zeros for t, _ in assignments(node))
            if left_at_zero or (is_stop(node, sent, outputs) and not self._only_logs(node)):
                return True
        called = {last_name(n.function) for n in in_branches if isinstance(n, Call)}
        helpers = (f for name in called for f in self.machine.runtime.functions_named(name))
        codes = [self._code(helper) for helper in islice(helpers, _MAX_REACHED)]
        return any(
            is_stop(node, _sent_names(each, stored), outputs)
            for each in codes
            for node in ir_nodes(each.function.body)
        )

    def _only_logs(self, node: object) -> bool:
        """Return whether a step calls functions of the program that all do nothing but log."""
        if not isinstance(node, Evaluate) or not isinstance(node.value, Call):
            return False
        named = list(self.machine.runtime.functions_named(last_name(node.value.function)))
        codes = [self._code(each) for each in named]
        logs = all(is_log(c) or is_logger(c) for each in codes for c in each.calls)
        return bool(codes) and logs and not any(each.members for each in codes)

    def _may_base_watch(self, callbacks: list[Function]) -> bool:
        """Return whether callbacks are methods of a class with a base that is not read."""
        keys = {each.key for each in callbacks}
        instances = [each for each in self.machine.instances if isinstance(each, Instance)]
        return any(
            method.function.key in keys
            for each in instances
            if not _STANDARD.issuperset(
                b.partition(".")[0] for b in unknown_bases(self.machine, each)
            )
            for method in methods(self.machine, each)
        )

    @staticmethod
    def _is_marked(reached: list[FunctionSteps], others: list[FunctionSteps]) -> bool:
        """Return whether a callback sets something to a value that others set back, and test."""
        marks = set[tuple[str, Expr]]().union(*(each.marks for each in reached))
        values = set[tuple[str, Expr]]().union(
            *(each.marks for each in others if not each.is_constructor)
        )
        changed = {name for name, _ in marks} & {name for name, _ in values - marks}
        return any(mentioned_names(t.condition) & changed for each in others for t in each.tests)

    def _reached(self, functions: Iterable[Function]) -> list[FunctionSteps]:
        """Return what functions do, with those that they call by name."""
        found = reachable_functions(self.machine, list(functions), include_unrelated=True)
        likely = _sources_first(islice(found, _MAX_FUNCTIONS), _MAX_REACHED)
        return [self._code(each) for each in likely]

    def _code(self, function: Function) -> FunctionSteps:
        if id(function) not in self._known:
            is_cpp = self.machine.runtime.passes_by_reference
            steps = FunctionSteps(function, is_cpp=is_cpp, clocks=self._clocks)
            self._known[id(function)] = steps
        return self._known[id(function)]


def _sources_first(functions: Iterable[Function], limit: int) -> Iterator[Function]:
    """Yield so many functions, those of headers last: these may be a whole library."""
    return islice(sorted(functions, key=lambda each: each.file.endswith(_HEADERS)), limit)


def _is_state(publisher: Declaration) -> bool:
    """Return whether a publisher tells what was measured, or how something stands."""
    return bool(_STATES.match(publisher.type)) and not _ORDERS.search(publisher.name)


def _times_of_taking(code: FunctionSteps, stored: set[str]) -> Iterator[str]:
    """Yield where a function keeps the time at which it took away what a callback had stored."""
    for node in dependent_nodes(code, stored) if is_cleared_by(code, stored) else ():
        for target, value in assignments(node):
            if is_time(value, code) and (name := code.member(target)):
                yield name


def _is_given(value: Expr, code: FunctionSteps) -> bool:
    """Return whether a value is made of what a function is given, or of its locals."""
    given = {param.name for param in code.function.params} - {"self"}
    given.update(name for name, _ in code.locals)
    return not given.isdisjoint(mentioned_names(value))


def _aliases(code: FunctionSteps, times: set[str]) -> tuple[frozenset[str], frozenset[str]]:
    """Return the names in a function that hold a time or an age, and those that hold a verdict."""
    names, flags = set(times), set[str]()
    for name, value in code.locals:
        if mentioned_names(value) & names:
            is_verdict = any(is_comparison(node) for node in ir_nodes(value))
            (flags if is_verdict else names).add(name)
    return frozenset(names), frozenset(flags)


def _zeroed_in_part(nodes: list[object], stored: set[str], codes: list[FunctionSteps]) -> set[str]:
    """Return the stored names that steps set to zero, if these go out with others that stay."""
    pairs = [pair for node in nodes for pair in assignments(node)]
    changed = set[str]().union(*(mentioned_names(target) for target, _ in pairs)) & stored
    zeroed = {name for t, v in pairs if is_zero(v) for name in mentioned_names(t)} & stored
    staying = {name for name in stored - changed if not _STEERING.search(name)}
    values = [c.args for each in codes for c in each.calls if not is_log(c)]
    values += [(value,) for each in codes for _, value in each.locals]
    is_part = any(mentioned_names(v) & zeroed and mentioned_names(v) & staying for v in values)
    return zeroed if zeroed and is_part else set()


def _tests_stamp(code: FunctionSteps, stored: set[str]) -> bool:
    """Return whether a function compares the stamp of a message that was stored with now."""
    values = [value for _, value in code.locals] + [test.condition for test in code.tests]
    clocks = (CLOCKS | code.clocks) - {"stamp"}
    is_read = any({"stamp"} & mentioned_names(v) and stored & mentioned_names(v) for v in values)
    is_read &= bool(clocks & mentioned_names(code.function.body))
    names, flags = _aliases(code, {"stamp"}) if is_read else (frozenset(), frozenset())
    return any(_is_about(test.condition, names, flags) for test in code.tests)


def _sent_names(code: FunctionSteps, stored: set[str]) -> frozenset[str]:
    """Return the names that a function makes of what was stored, or gives to others."""
    calls = [call for call in code.calls if not is_log(call)]
    given = [mentioned_names(part) for call in calls for part in (call.args, call.keywords)]
    sums = [n for n in ir_nodes(code.function.body) if isinstance(n, Binary) and n.operator == "+"]
    sides = [(mentioned_names(a), mentioned_names(b)) for n in sums for a, b in _orders(n)]
    addends = {name for one, other in sides if one & stored for name in other} - stored
    return frozenset({RESULT, *made_of(code, stored)}).union(*given) - SELF - addends


def _orders(sum: Binary) -> tuple[tuple[Expr, Expr], ...]:
    return (sum.left, sum.right), (sum.right, sum.left)


def _returns_verdict(code: FunctionSteps, times: set[str]) -> bool:
    """Return whether a function returns how a time compares with now."""
    names, flags = _aliases(code, times)
    return any(_is_about(value, names, flags) for value in code.returned)


def _is_about(condition: Expr, names: frozenset[str], flags: frozenset[str] | set[str]) -> bool:
    return bool(mentioned_names(condition) & flags) or any(
        is_comparison(node) and mentioned_names(node) & names for node in ir_nodes(condition)
    )


def _limit(condition: Expr, names: frozenset[str]) -> float | None:
    """Return the number that an age is compared with, alone or as a duration, if it is written."""
    for node in ir_nodes(condition):
        if is_comparison(node) and mentioned_names(node) & names:
            for side in (node.left, node.right):
                found = [n.value for n in ir_nodes(side) if isinstance(n, Const)]
                is_limit = len(found) == 1 and not mentioned_names(side) & (names | CLOCKS)
                if is_limit and isinstance(found[0], (int, float)):
                    return float(found[0])
    return None
