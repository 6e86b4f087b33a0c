"""What a program writes to hardware when it starts, or by timers, whatever it gets or does not."""

from collections.abc import Collection, Iterator, Mapping
from dataclasses import dataclass, field
from itertools import chain

from rtron.sources.code import ir
from rtron.sources.code.call_kinds import only_prepares, stops_motion
from rtron.sources.code.program_steps import Program, Steps, last_name, mentioned_names
from rtron.vocabulary import Evidence

_OFF = frozenset({"LOW", "False", "false"})


@dataclass
class StartFlow:
    """Follows what runs when a program starts, and by timers, and depends on nothing it gets.

    `data` are, for each input, the members and the functions that hold it; `inputs` get it. Zeros,
    stops and what only prepares hardware are no motion.
    """

    program: Program
    data: Collection[tuple[Mapping[str, set[str]], set[str]]]
    inputs: Collection[tuple[str, int, str]]
    _found: dict[str, Evidence] = field(default_factory=dict)

    def writes(self) -> dict[str, Evidence]:
        """Return the libraries that are written to, each with the first place."""
        given = chain.from_iterable(self.program.machine.callbacks_at.values())
        first = [f for f in self.program.functions if _is_first(f)]
        pending, done = [*self.program.machine.module_loops, *first, *given], set(self.inputs)
        while pending:
            function = pending.pop(0)
            if function.key not in done and function.body:
                done.add(function.key)
                pending += self._calls(self.program.steps(function))
        return self._found

    def _calls(self, code: Steps) -> Iterator[ir.Function]:
        """Note what a function writes by itself, and yield what it calls by itself."""
        held = (members.get(code.scope, set()) | results for members, results in self.data)
        names = set[str]().union(*held)
        ids = code.depending(code.made_of(names & code.names))
        for write in code.writes:
            is_set_up = any(only_prepares(last_name(each)) for each in write.targets)
            is_idle = id(write) in ids or is_set_up or _is_zero(write.value)
            library = "" if is_idle else code.written(write)
            self._keep(library, code, write.line)
        for call in code.calls:
            name = last_name(call.function)
            if id(call) in ids or _is_idle(call, name):
                continue
            library = self.program.libraries.called(call, code.scope)
            if library and call.args and id(call) in code.done:
                self._keep(library, code, call.line)
            elif not library:
                yield from self.program.called({name}, code.scope)

    def _keep(self, library: str, code: Steps, line: int) -> None:
        if library:
            self._found.setdefault(library, Evidence(file=code.function.file, line=line))


def _is_first(function: ir.Function) -> bool:
    """Return whether a function runs when a program or an object begins."""
    *_, owner, name = ("", *function.name.split("::"))
    return name in {"main", "__init__", "run", "setup", "loop"} or owner == name


def _is_idle(call: ir.Call, name: str) -> bool:
    """Return whether a call stops something, or only prepares it."""
    given = [*call.args, *(value for _, value in call.keywords)]
    is_off = bool(given) and _is_zero(given[-1])
    return is_off or only_prepares(name) or stops_motion(name)


def _is_zero(value: ir.Expr) -> bool:
    """Return whether a value is a zero, or a name of what is off."""
    if isinstance(value, ir.SequenceExpr):
        return all(map(_is_zero, value.items))
    if isinstance(value, ir.Const):
        return not isinstance(value.value, (str, bytes)) and not value.value
    return bool(mentioned_names(value) & _OFF)
