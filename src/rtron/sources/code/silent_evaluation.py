"""What expressions and statements do as a program runs in silence.

Numbers of the message are samples, marked as MESSAGE, which goes into whatever is made of them;
readings of the clock are marked as CLOCK. What the program's source does not define is the outside:
to call it, or to write to a part of it, is an output.
"""

from dataclasses import dataclass, replace
from typing import Any

from rtron.sources.code import ir
from rtron.sources.code.interpreter import abstract_values as av
from rtron.sources.code.interpreter.cpp.mutating_methods import mutate
from rtron.sources.code.interpreter.execution import expressions, statements
from rtron.sources.code.interpreter.execution.abstract_machine import (
    AbstractMachine,
    Outcome,
    ThrownError,
)
from rtron.sources.code.interpreter.execution.arguments import Arguments
from rtron.sources.code.interpreter.execution.assignment import assign, slot_of
from rtron.sources.code.interpreter.execution.calls import (
    callee_name,
    dispatch_noting_tasks,
    evaluate_arguments,
)
from rtron.sources.code.interpreter.execution.exceptions import is_logging_call
from rtron.sources.code.interpreter.execution.language_runtime import cpp_runtime
from rtron.sources.code.interpreter.execution.stack_frame import StackFrame
from rtron.sources.code.ir.references import last_name
from rtron.sources.code.library_models.common.message_types import cpp_message_type
from rtron.sources.code.silent_library import (
    CLOCKS,
    COMPUTING,
    LOGGING,
    NUMERIC,
    RUNNING,
    SLEEPS,
    TIMES,
    UNITS,
    compute,
    is_endless,
    is_message_object,
    message_taint,
    scaled,
    topic_of,
)
from rtron.sources.code.silent_outputs import SilentState, WaitsError, reason_of
from rtron.sources.declaration import DeclarationKind
from rtron.vocabulary import Evidence

STEP_GROWTH = 2.0
LATE_ROUND = 4
"""From which round on an age is more than a limit that is not known."""
_INNER_STEP, _MAX_INNER_ROUNDS = 0.01, 16
"""How long the clock goes on after the first round of a loop within a task (s)."""
_ORDERS = frozenset({"<", "<=", ">", ">="})
_ATOMIC = frozenset({"load", "store", "exchange"})
_TAKING = frozenset({"get", "get_nowait"})
_FOREVER = ir.While(ir.Const(value=True), ())
_EVENT = "threading.Event()"


@dataclass(eq=False, slots=True)
class SilentEvaluation(SilentState):
    """Evaluates and runs what differs in silence."""

    def evaluators(self) -> dict[type, Any]:
        """Return what evaluates expressions otherwise than elsewhere."""
        return {
            ir.Attr: self._attr,
            ir.Name: self._name,
            ir.Binary: self._binary,
            ir.Call: self._call,
            ir.New: self._new,
            ir.Conditional: self._conditional,
        }

    def executors(self) -> dict[type, Any]:
        """Return what runs statements otherwise than elsewhere."""
        return {
            ir.Assign: self._assign,
            ir.Declare: self._declare,
            ir.If: self._if,
            ir.While: self._while,
        }

    def _attr(self, machine: AbstractMachine, node: ir.Attr, frame: StackFrame) -> av.Value:
        owner = machine.evaluate(node.owner, frame)
        found = [self._member(machine, each, node, frame) for each in av.options(owner)]
        return self._or_outside(node.name, av.join(found))

    def _member(
        self, machine: AbstractMachine, owner: av.Value, node: ir.Attr, frame: StackFrame
    ) -> av.Value:
        if isinstance(owner, av.Unknown) and owner.tainted & av.MESSAGE:
            if node.name == "stamp":
                return av.Scalar(0.0, av.CLOCK)
            return av.Unknown(f"{owner.label}.{node.name}", owner.tainted)
        if node.name in UNITS and (number := scaled(owner, UNITS[node.name])):
            return number
        owner = self._as_message(owner, node.owner, frame)
        if isinstance(owner, av.Instance) and is_message_object(owner):
            if node.name not in owner.fields:
                machine.undo_log.set(owner.fields, node.name, av.Instance(av.UNSET))
            return owner.fields[node.name]
        return expressions.member_of(machine, owner, node, frame)

    def _is_message(self, type: ir.TypeRef | None) -> bool:
        name = cpp_message_type(type)
        kinds = (DeclarationKind.PUBLISH, DeclarationKind.SUBSCRIBE)
        declared = (each for kind in kinds for each in self.machine.recorder.declared(kind))
        return "msg" in name.rpartition("/")[0] or any(name == each.type for each in declared)

    def _name(self, machine: AbstractMachine, node: ir.Name, frame: StackFrame) -> av.Value:
        return self._or_outside(node.id, expressions.EVALUATORS[ir.Name](machine, node, frame))

    def _or_outside(self, name: str, value: av.Value) -> av.Value:
        """Return a value, or any other if something from outside may have been put there."""
        self.is_used |= self.round > 0 and av.taint(value) & av.MESSAGE != 0
        is_plain = isinstance(value, (av.Scalar, av.Unknown)) and name in self.outside
        return av.join((value, av.Unknown(name, av.OUTSIDE))) if is_plain else value

    def _as_message(self, value: av.Value, node: ir.Expr, frame: StackFrame) -> av.Value:
        """Return an object for a message of C++ that was made without one, and keep it there."""
        if isinstance(value, av.Unknown) and not value.tainted and self._is_message(value.type):
            slot = slot_of(self.machine, node, frame)
            value = av.Instance(av.UNSET)
            if slot is not None:
                self.machine.undo_log.set(*slot, value)
        return value

    def _new(self, machine: AbstractMachine, node: ir.New, frame: StackFrame) -> av.Value:
        name = node.type.name.rpartition("::")[2]
        if name not in TIMES | UNITS.keys() | NUMERIC.keys():
            return expressions.EVALUATORS[ir.New](machine, node, frame)
        values = tuple(machine.evaluate(each, frame) for each in node.args)
        given = Arguments(values=values, frame=frame)
        return compute(name, given, node.type.args) or av.Scalar(0.0)

    def _binary(self, machine: AbstractMachine, node: ir.Binary, frame: StackFrame) -> av.Value:
        left, right = machine.evaluate(node.left, frame), machine.evaluate(node.right, frame)
        if node.operator in _ORDERS and (av.taint(left) | av.taint(right)) & av.CLOCK:
            return self._compare_times(node, left, right, frame)
        return expressions.combine(machine, node, (left, right), frame)

    def _compare_times(
        self, node: ir.Binary, left: av.Value, right: av.Value, frame: StackFrame
    ) -> av.Value:
        """Compare a time with a limit; one that is not known is over after some rounds."""
        self.is_timed = True
        distance = av.binary("-", left, right)
        answer = expressions.combine(self.machine, node, (left, right), frame)
        sides = [isinstance(each, av.Scalar) for each in (left, right)]
        if not isinstance(answer, av.Scalar) and any(sides):
            is_late = self.round >= LATE_ROUND
            answer = av.Scalar(is_late is (sides[0] == (node.operator in {">", ">="})), av.CLOCK)
        if isinstance(answer, av.Scalar):
            self.note_comparison(node, frame, answer, distance)
        return av.with_taint(answer, av.CLOCK)

    def _conditional(
        self, machine: AbstractMachine, node: ir.Conditional, frame: StackFrame
    ) -> av.Value:
        test = machine.evaluate(node.test, frame)
        decided, more = self.truth(test), av.taint(test) & av.MESSAGE
        if decided is None:
            sides = [machine.evaluate(each, frame) for each in (node.body, node.orelse)]
            return av.with_taint(av.join(sides), more)
        return av.with_taint(machine.evaluate(node.body if decided else node.orelse, frame), more)

    def _call(self, machine: AbstractMachine, node: ir.Call, frame: StackFrame) -> av.Value:
        name = last_name(node.function)
        if machine.runtime.passes_by_reference and (changed := mutate(machine, node, frame)):
            return changed
        if (known := self._result_by_name(name, node)) is not None:
            return known
        called = machine.evaluate(node.function, frame)
        arguments = self._with_arrays(node, evaluate_arguments(machine, node, frame), frame)
        if isinstance(called, av.Scalar) or av.taint(called) & av.CLOCK:
            return called
        is_scanned = isinstance(called, (av.FunctionValue, av.ClassValue))
        types = node.function.types if isinstance(node.function, (ir.Name, ir.Attr)) else ()
        if not is_scanned and (made := compute(name, arguments, types)):
            return made
        if isinstance(called, av.ExternalSymbol):
            called = machine.runtime.find_by_arguments(called.name, arguments) or called
        if _is_outside(called):
            return self._call_outside(node, called, arguments, frame)
        if name in _TAKING and isinstance(called, av.LibraryFunction):
            self._wait_for_item(name, called.owner, arguments, frame)
        made = dispatch_noting_tasks(machine, called, arguments)
        is_unknown = isinstance(made, av.Unknown)
        return av.with_taint(made, message_taint(arguments.all_values)) if is_unknown else made

    def _result_by_name(self, name: str, node: ir.Call) -> av.Value | None:
        """Return what a clock reads, and what says that the node runs; logs do nothing."""
        if is_logging_call(node) or LOGGING.fullmatch(name):
            return av.NONE
        if name in RUNNING and not node.args:
            return av.Scalar(RUNNING[name])
        if name in CLOCKS and len(node.args) <= (name == "now"):
            return av.Scalar(self.clock * CLOCKS[name], av.CLOCK)
        return None

    @staticmethod
    def _wait_for_item(name: str, owner: av.Value, arguments: Arguments, frame: StackFrame) -> None:
        """Let an empty queue throw after its timeout, or wait for ever."""
        if isinstance(owner, av.ListValue) and not (owner.items or owner.open):
            is_limited = name != "get" or len(arguments.values) > 1 or bool(arguments.keywords)
            if is_limited or av.FALSE in arguments.values:
                raise ThrownError("Empty", has_unknown_bases=True)
            raise WaitsError(_FOREVER, frame)

    def _with_arrays(self, node: ir.Call, given: Arguments, frame: StackFrame) -> Arguments:
        """Return arguments with the whole of each array of which an address is given.

        What is written to an element by reference is not written to the whole.
        """
        values, slots = list(given.values), list(given.slots)
        for at, arg in enumerate(node.args[: len(slots)]):
            owner = self.machine.evaluate(arg.owner, frame) if isinstance(arg, ir.Index) else None
            if isinstance(owner, av.ListValue):
                values[at] = owner if at in node.addresses else values[at]
                slots[at] = None
        return replace(given, values=tuple(values), slots=tuple(slots))

    def _call_outside(
        self, node: ir.Call, called: av.Value, arguments: Arguments, frame: StackFrame
    ) -> av.Value:
        name, owner = last_name(node.function), None
        if isinstance(node.function, ir.Attr):
            owner = self.machine.evaluate(node.function.owner, frame)
            if isinstance(owner, av.Unknown) and owner.label == _EVENT:
                return self._use_event(node.function, owner, frame)
            if av.is_message(owner):
                return av.Unknown(name, av.MESSAGE)
            if name in _ATOMIC:
                return self._use_atomic(node.function, owner, arguments, frame)
        if self._is_message(ir.TypeRef(callee_name(called))):
            return av.Instance(av.UNSET)
        values = arguments.all_values
        if isinstance(called, av.Instance):
            values = (*values, owner or called)
        if name.endswith(("Error", "Exception")):
            return av.Unknown(name)
        if name not in SLEEPS and not COMPUTING.fullmatch(callee_name(called)):
            function = node.function
            target = last_name(function.owner) if isinstance(function, ir.Attr) else name
            at = Evidence(file=frame.file, line=node.line)
            self.send(target, name, values, at, topic_of(owner) if name == "publish" else "")
        self.handed += (each for each in values if isinstance(each, av.FunctionValue))
        return av.with_taint(av.Unknown(f"{callee_name(called)}()"), message_taint(values))

    def _use_atomic(
        self, function: ir.Attr, held: av.Value, arguments: Arguments, frame: StackFrame
    ) -> av.Value:
        """`load`, `store` and `exchange` of a std::atomic, which is what it holds."""
        slot = slot_of(self.machine, function.owner, frame)
        if slot is not None and arguments.values:
            self.machine.undo_log.set(*slot, self.caused(arguments.values[0]))
        return held

    def _use_event(self, function: ir.Attr, event: av.Unknown, frame: StackFrame) -> av.Value:
        """`set`, `clear`, `wait`, `is_set` of a threading.Event: its mark says that it is set."""
        slot = slot_of(self.machine, function.owner, frame)
        if function.name in {"set", "clear"} and slot is not None:
            mark = av.MESSAGE if function.name == "set" else 0
            self.machine.undo_log.set(*slot, replace(event, tainted=mark))
        return av.Scalar(event.tainted & av.MESSAGE != 0, event.tainted)

    def _assign(self, machine: AbstractMachine, node: ir.Assign, frame: StackFrame) -> Outcome:
        value = self.caused(machine.evaluate(node.value, frame))
        machine.line = node.line
        for target in node.targets:
            if isinstance(target, (ir.Attr, ir.Index)):
                self._note_written(target, value, Evidence(file=frame.file, line=node.line), frame)
            is_braced = machine.runtime.passes_by_reference and isinstance(
                node.value, statements.BRACED
            )
            made = cpp_runtime(machine).braces_for(target, value, frame) if is_braced else value
            assign(machine, target, made, frame)
        return None

    def _note_written(
        self, target: ir.Attr | ir.Index, value: av.Value, place: Evidence, frame: StackFrame
    ) -> None:
        """Send what is written to a part of the outside; a variable keeps it, too."""
        owner = self.machine.evaluate(target.owner, frame)
        if isinstance(owner, (av.Unknown, av.ExternalSymbol)) and not av.is_message(owner):
            name = target.name if isinstance(target, ir.Attr) else ""
            self.send(last_name(target.owner), name, (value,), place)
            self.handed += [value] if isinstance(value, av.FunctionValue) else []
            if isinstance(owner, av.Unknown) and isinstance(target, ir.Attr):
                self._make_record(target.owner, frame)

    def _make_record(self, node: ir.Expr, frame: StackFrame) -> None:
        """Let a variable, and those it is a part of, hold what is written to their parts."""
        if isinstance(node, ir.Attr):
            owner = self.machine.evaluate(node.owner, frame)
            if isinstance(owner, av.Unknown):
                self._make_record(node.owner, frame)
        slot = slot_of(self.machine, node, frame)
        if slot is not None:
            self.machine.undo_log.set(*slot, av.Instance(av.UNSET))

    def _declare(self, machine: AbstractMachine, node: ir.Declare, frame: StackFrame) -> Outcome:
        if node.value is None and self._is_message(node.type) and not node.pointer:
            machine.undo_log.set(frame.variables, node.name, av.Instance(av.UNSET))
            return None
        return statements.EXECUTORS[ir.Declare](machine, node, frame)

    def _if(self, machine: AbstractMachine, node: ir.If, frame: StackFrame) -> Outcome:
        test = machine.evaluate(node.test, frame)
        decided = self.truth(test)
        self.reasons.append(reason_of(av.taint(test), is_decided=decided is not None))
        try:
            if decided is None:
                return statements.run_both_sides(machine, node, frame)
            return machine.execute(node.body if decided else node.orelse, frame)
        finally:
            self.reasons.pop()

    def _while(self, machine: AbstractMachine, node: ir.While, frame: StackFrame) -> Outcome:
        """Run a loop while its test is decided.

        One that does not end is a task; one within it that waits for the outside ends some time.
        """
        step = _INNER_STEP
        for _ in range(_MAX_INNER_ROUNDS):
            decided = self.truth(machine.evaluate(node.test, frame))
            if decided is False and not node.first:
                return None
            if self.is_starting or is_endless(node):
                raise WaitsError(node, frame)
            if decided is None or isinstance(node.test, ir.Const):
                break
            outcome = machine.execute(node.body, frame)
            if outcome in {"return", "raise", "break"}:
                return None if outcome == "break" else outcome
            machine.execute(node.step, frame)
            self.clock += step
            step *= STEP_GROWTH
        outcome = machine.execute(node.body, frame)
        is_left = outcome in {"return", "raise"} and isinstance(node.test, ir.Const)
        return outcome if is_left else None


def _is_outside(called: av.Value) -> bool:
    """Return whether a value is called whose source is not here."""
    is_record = isinstance(called, av.Instance) and called.type is av.UNSET
    is_declared = isinstance(called, av.FunctionValue) and called.function.body is None
    return is_record or is_declared or isinstance(called, (av.Unknown, av.ExternalSymbol))
