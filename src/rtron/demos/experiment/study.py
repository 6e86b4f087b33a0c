"""The variants of cases in worlds: the app as it is, and the guarded app."""

import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING

from rtron.demos.cases import Case, Decisions, RunConditions
from rtron.demos.cases.case_study import merge_decisions
from rtron.demos.experiment.incident import CaseIncident, wait_for_incident
from rtron.demos.experiment.session import AppSession
from rtron.demos.metrics.case_run import SECOND, CaseRun, Event, RunsByVariant, Variant, first_stop
from rtron.demos.metrics.message_journal import measure_deviation
from rtron.demos.runtime.app_launch import launch_app
from rtron.demos.runtime.environment import DemoEnvironment
from rtron.demos.runtime.instrumentation import InstrumentationPipeline
from rtron.demos.runtime.isolation import APP_NAME, launch_file
from rtron.demos.runtime.service import DemoService
from rtron.demos.world.scenes.generator import make_scene
from rtron.demos.world.simulation import CAMERA_RATE
from rtron.planning.plan_file.loader import read_plan
from rtron.sources.graph_json import GraphFile
from rtron.vocabulary import Risk, build_streams
from rtron.workflows.scan import scan_graph

if TYPE_CHECKING:
    from rtron.demos.runtime.processes import CompletedCommand


def with_verdicts(run: CaseRun, case: Case, events: Sequence[Event], plan: Path) -> CaseRun:
    """Return a guarded run with what the guard told in its time, a second more for counts."""
    ended = run.start_wall + run.ended / run.speed + 1
    run_events = tuple(e for e in events if run.start_wall <= e["at"] / SECOND <= ended)
    stopped = first_stop(run_events, case.topic, case.attacker)
    after = None
    if run.attack.sent and stopped is not None:
        after = max(0.0, stopped - run.attack.sent[0])
    return replace(run, events=run_events, mitigated_after=after, publishers=_publishers(plan))


def _publishers(plan: Path) -> dict[tuple[str, str], str]:
    found = build_streams(read_plan(plan))
    return {(each.topic, flow.name): flow.publisher for each in found for flow in each.flows}


def worlds_by_decisions(
    cases: Sequence[Case], seeds: Sequence[int], setting: Callable[[Case, int], RunConditions]
) -> Sequence[tuple[Decisions, Sequence[int]]]:
    """Return decisions against all cases, each with the seeds of the worlds in a row it is for."""
    found: list[tuple[Decisions, list[int]]] = []
    for seed in seeds:
        decisions = merge_decisions(case.decisions(setting(case, seed)) for case in cases)
        if not found or found[-1][0] != decisions:
            found.append((decisions, []))
        found[-1][1].append(seed)
    return found


@dataclass(frozen=True, slots=True)
class ProgressListener:
    """Takes what happens now, and each run that is done."""

    on_activity: Callable[[str], None]
    on_run: Callable[[CaseRun], None]


_COUNTS_DELAY = 3 * SECOND // 2
"""So long (ns) after a run the guard has told its counts, which it does once a second."""
_UNGUARDED = (Variant.UNATTACKED, Variant.ATTACKED)


class Study:
    """Runs cases in the worlds of seeds, first without the guard, then with it; `runs` grows.

    One guarded app stands against all cases. `incidents` are by case and seed, `decisions` by
    case; they, `plan` and `commands`, the commands that led to the guarded app and what they
    printed, are those of the first world, where each has its own.
    """

    def __init__(
        self,
        environment: DemoEnvironment,
        cases: Sequence[Case],
        seeds: Sequence[int],
        listener: ProgressListener,
    ) -> None:
        self.pipeline = InstrumentationPipeline(environment, environment.folder)
        self.runs: list[CaseRun] = []
        self.incidents: dict[tuple[str, int], CaseIncident] = {}
        self.decisions: dict[str, Decisions] = {}
        self.plan = ""
        self.commands: Sequence[CompletedCommand] = ()
        self._running = ExitStack()
        self._environment = environment
        self._cases = cases
        self._seeds = seeds
        self._listener = listener

    def runs_of(self, case: str, seed: int) -> RunsByVariant:
        """Return the runs of a case in one world, by variant."""
        found = (run for run in self.runs if (run.case, run.seed) == (case, seed))
        return {run.variant: run for run in found}

    def without_guard(self, case: str) -> Mapping[int, str]:
        """Return by world what would have been in the incidents of a case without the guard."""
        return {
            seed: each.sentence for (name, seed), each in self.incidents.items() if name == case
        }

    def risks(self) -> Sequence[Risk]:
        """Return the risks that the scan found, in the order of kinds."""
        return scan_graph(GraphFile(self.pipeline.graph).read()).report.risks

    def run_unguarded(self) -> None:
        """Scan the app and run it as it is: each case in each world, without and with an attack.

        SourceError if something that it needs has ended or does not answer.
        """
        self._listener.on_activity("rtron scan: who can interfere with whom?")
        self.pipeline.scan()
        self.commands = tuple(self.pipeline.commands)
        self._listener.on_activity("starting the app as it is")
        with launch_app(self._environment, launch_file(self._environment.ros)) as app:
            session = AppSession(self._environment, app)
            session.wait_until_connected()
            for case in self._cases:
                for seed in self._seeds:
                    for variant in _UNGUARDED:
                        self._add_run(self._run(session, case, seed, variant))

    @contextmanager
    def guarded_session(self, service: DemoService) -> Iterator[None]:
        """Attack the guarded app: each case in each world. Call `run_unguarded` before.

        The last guarded app runs on until the end of the block. The service records the guard's
        decisions, which become part of the runs; it gets the app's graph, too.
        """
        service.wait()
        with self._running:
            worlds = worlds_by_decisions(self._cases, self._seeds, self._conditions)
            for decisions, seeds in worlds:
                self._run_with_decisions(decisions, seeds, service)
            yield

    def _conditions(self, case: Case, seed: int) -> RunConditions:
        """Return what decisions of a case may depend on in the world of a seed."""
        scene, speed = make_scene(case.name, seed), self._environment.speed
        return RunConditions(scene=scene, speed=speed, rate=CAMERA_RATE)

    def _run_with_decisions(
        self, decisions: Decisions, seeds: Sequence[int], service: DemoService
    ) -> None:
        self._running.close()
        launch = self._instrument(decisions)
        began = time.time_ns()
        session = self._launch(launch, service.environ())
        cases = [(case, seed) for case in self._cases for seed in seeds]
        runs = [(case, self._run(session, case, seed, Variant.GUARDED)) for case, seed in cases]
        for case, run in runs:
            if case.over_bridge:
                self._note_incident(case, run)
        events = service.events(began, time.time_ns() + _COUNTS_DELAY)
        service.upload(self.pipeline.graph)
        for case, run in runs:
            self._add_run(with_verdicts(run, case, events, self.pipeline.plan))

    def _note_incident(self, case: Case, run: CaseRun) -> None:
        environment = self._environment
        self.incidents[case.name, run.seed] = wait_for_incident(
            environment.state, case.topic, run.start_wall, environment.speed
        )

    def _instrument(self, decisions: Decisions) -> Path:
        """Return the launch file of an app that is guarded by what was decided."""
        self._listener.on_activity("rtron plan, check, instrument: what should stand in between?")
        launch = self.pipeline.instrument({"app": APP_NAME, **decisions})
        if not self.decisions:
            self.commands = tuple(self.pipeline.commands)
            self.plan = self.pipeline.plan.read_text(encoding="utf-8")
            for case in self._cases:
                setting = self._conditions(case, self._seeds[0])
                self.decisions[case.name] = case.decisions(setting)
        return launch

    def _launch(self, launch: Path, more: Mapping[str, str]) -> AppSession:
        """Start a guarded app, which runs until the next one does."""
        self._listener.on_activity("starting the guarded app")
        app = launch_app(self._environment, launch, more, self.pipeline.plan)
        session = AppSession(
            self._environment,
            self._running.enter_context(app),
            plan=self.pipeline.plan,
        )
        session.wait_until_connected()
        return session

    def _run(self, session: AppSession, case: Case, seed: int, variant: Variant) -> CaseRun:
        self._listener.on_activity(f"{case.name}, world {seed}: {variant}")
        return session.run_case(case, seed, variant)

    def _add_run(self, run: CaseRun) -> None:
        """Keep a run with how far it is from the unattacked one, which came before it."""
        reference = self.runs_of(run.case, run.seed).get(Variant.UNATTACKED)
        off = measure_deviation(run.trajectory, reference.trajectory) if reference else None
        measured = replace(run, deviation=off)
        self.runs.append(measured)
        self._listener.on_run(measured)
