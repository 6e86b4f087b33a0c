"""Measurement of a run of the app: observed, as a dry run, or from a recording."""

import logging
from collections.abc import Callable, Iterable, Sequence
from dataclasses import replace

from rtron.errors import RTronError
from rtron.guard.core.observations import EventSource, Observations, observations_of
from rtron.guard.core.stream import GuardedStream
from rtron.guard.measurement.activity import ActivityPhases
from rtron.guard.measurement.frame_rates import FrameRateMeasurement
from rtron.guard.measurement.histogram import duration_figures
from rtron.guard.measurement.stream import StreamMeasurement
from rtron.guard.transport.common.protocol import Transport
from rtron.policies.mission.rule_block import RuleResult
from rtron.vocabulary import SECOND, EventStatistics, MeasuredRun, Plan

log = logging.getLogger(__name__)

WriteFigures = Callable[[MeasuredRun], None]
"""Writes the figures so far; RTronError if that is not possible."""

WRITE_PERIOD = 10 * SECOND


class RunMeasurement:
    """The figures of a whole plan; its coordinator must use `observations`."""

    def __init__(self, plan: Plan, transport: Transport) -> None:
        self._plan = plan
        self._transport = transport
        self._start_time = transport.now()
        self._rates = FrameRateMeasurement(plan.fps_monitor)
        self._events: dict[str, ActivityPhases] = {}
        self._streams: list[tuple[GuardedStream, StreamMeasurement]] = []
        observations = observations_of(plan)
        observations.rates.monitors.update(self._rates.monitors)
        self.observations: Observations = replace(
            observations, events=tuple(map(self._measured_source, observations.events))
        )

    def measure(self, streams: Iterable[GuardedStream]) -> None:
        """Measure these streams from now on."""
        for each in streams:
            each.measurement = StreamMeasurement(each.spec, self._rates)
            self._streams.append((each, each.measurement))

    def figures(self) -> MeasuredRun:
        """Return the figures so far."""
        now = self._transport.now()
        return MeasuredRun(
            app=self._plan.app,
            ros=self._plan.ros,
            duration=now - self._start_time,
            streams=tuple(
                measurement.figures(now, tuple(stream.strangers))
                for stream, measurement in self._streams
            ),
            monitors=tuple(each.figures() for each in self._rates.monitors.values()),
            events=tuple(_event_figures(name, phases) for name, phases in self._events.items()),
        )

    def write_periodically(self, write: WriteFigures) -> None:
        """Write the figures now, RTronError if that fails, and every `WRITE_PERIOD` from now on."""
        write(self.figures())
        self._schedule_write(write)

    def _schedule_write(self, write: WriteFigures) -> None:
        due = self._transport.now() + WRITE_PERIOD
        self._transport.call_at(due, lambda: self._write_again(write))

    def _write_again(self, write: WriteFigures) -> None:
        try:
            write(self.figures())
        except RTronError as error:
            log.error("the figures are not written: %s", error)  # noqa: TRY400 - the message is enough
        self._schedule_write(write)

    def _measured_source(self, source: EventSource) -> EventSource:
        phases = ActivityPhases()
        self._events |= {bit.flow.name: phases for bit in source.bits}

        def judgements_of(message: bytes) -> Sequence[RuleResult]:
            phases.add_message(self._transport.now())
            return source.evaluate(message)

        return replace(source, evaluate=judgements_of)


def _event_figures(name: str, phases: ActivityPhases) -> EventStatistics:
    gaps, pauses = phases.gaps_and_pauses()
    return EventStatistics(
        name=name,
        messages=phases.messages,
        gaps=duration_figures(gaps),
        pauses=duration_figures(pauses),
    )
