"""Measuring a run: what a guard keeps of an app that it watches, a dry run or a recording."""

import logging
from collections.abc import Callable, Iterable, Sequence
from dataclasses import replace

from rtron.errors import RTronError
from rtron.guard.core.observations import EventSource, Senses, senses_of
from rtron.guard.core.stream import GuardedStream
from rtron.guard.measurement.activity import Phases
from rtron.guard.measurement.frame_rates import MeasuredRates
from rtron.guard.measurement.histogram import duration_figures
from rtron.guard.measurement.stream import MeasuredStream
from rtron.guard.transport.common.protocol import Transport
from rtron.policies.mission.rule_block import Judgement
from rtron.vocabulary import SECOND, EventFigures, Plan, Run

log = logging.getLogger(__name__)

Write = Callable[[Run], None]
"""Keeps the figures so far; RTronError if that is not possible."""

WRITE_PERIOD = 10 * SECOND


class Measuring:
    """The figures of a whole plan; `senses` are what its host must use."""

    def __init__(self, plan: Plan, transport: Transport) -> None:
        self._plan = plan
        self._transport = transport
        self._began = transport.now()
        self._rates = MeasuredRates(plan.fps_monitor)
        self._events: dict[str, Phases] = {}
        self._guarded: list[tuple[GuardedStream, MeasuredStream]] = []
        senses = senses_of(plan)
        senses.rates.monitors.update(self._rates.monitors)
        self.senses: Senses = replace(senses, events=tuple(map(self._measured, senses.events)))

    def watch(self, guarded: Iterable[GuardedStream]) -> None:
        """Measure these streams, too, from now on."""
        for each in guarded:
            each.measured = MeasuredStream(each.stream, self._rates)
            self._guarded.append((each, each.measured))

    def run(self) -> Run:
        """Return what was measured so far."""
        now = self._transport.now()
        return Run(
            app=self._plan.app,
            ros=self._plan.ros,
            duration=now - self._began,
            streams=tuple(
                measured.figures(now, tuple(guarded.strangers))
                for guarded, measured in self._guarded
            ),
            monitors=tuple(each.figures() for each in self._rates.monitors.values()),
            events=tuple(_event(name, phases) for name, phases in self._events.items()),
        )

    def keep(self, write: Write) -> None:
        """Write the figures now, RTronError if that fails, and every now and then from now on."""
        write(self.run())
        self._later(write)

    def _later(self, write: Write) -> None:
        due = self._transport.now() + WRITE_PERIOD
        self._transport.call_at(due, lambda: self._again(write))

    def _again(self, write: Write) -> None:
        try:
            write(self.run())
        except RTronError as error:
            log.error("the figures are not written: %s", error)  # noqa: TRY400 - it tells enough
        self._later(write)

    def _measured(self, source: EventSource) -> EventSource:
        phases = Phases()
        self._events |= {bit.flow.name: phases for bit in source.bits}

        def judged(message: bytes) -> Sequence[Judgement]:
            phases.heard(self._transport.now())
            return source.judge(message)

        return replace(source, judge=judged)


def _event(name: str, phases: Phases) -> EventFigures:
    gaps, pauses = phases.parted()
    return EventFigures(
        name=name,
        messages=phases.messages,
        gaps=duration_figures(gaps),
        pauses=duration_figures(pauses),
    )
