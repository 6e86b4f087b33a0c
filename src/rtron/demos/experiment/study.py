"""The variants of cases in worlds: the app as it is, and the guarded app."""

import time
from collections.abc import Iterator, Mapping, Sequence
from contextlib import ExitStack, contextmanager
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from rtron.demos.cases import Case, Decisions, Setting
from rtron.demos.experiment.deciding import by_decisions
from rtron.demos.experiment.judged import with_verdicts
from rtron.demos.experiment.session import Session
from rtron.demos.experiment.wanted import Tell, Wanted
from rtron.demos.metrics.case_run import Run, Runs, Variant
from rtron.demos.metrics.deviation import deviation
from rtron.demos.metrics.guard_events import SECOND, Event
from rtron.demos.metrics.trajectory import Scene, way
from rtron.demos.runtime.app_files import NAME, launch_file
from rtron.demos.runtime.environment import Begun
from rtron.demos.runtime.instrumentation import Pipeline
from rtron.demos.runtime.service import Service
from rtron.risks import discover
from rtron.sources.graph_json import GraphFile
from rtron.vocabulary import Risk

if TYPE_CHECKING:
    from rtron.demos.runtime.processes import Finished

_COUNTED = 3 * SECOND // 2
"""So long (ns) after a run the guard has told its counts, which it does once a second."""
_UNGUARDED = (Variant.UNATTACKED, Variant.ATTACKED)


class Study:
    """Runs what is wanted, first without the guard, then with it; `runs` grows meanwhile.

    One guarded app stands against all cases. `scenes` are by case and seed, `decisions` by case;
    they, `plan` and `said`, the commands that led to the guarded app and what they printed, are
    those of the first world, where each has its own.
    """

    def __init__(self, begun: Begun, wanted: Wanted, tell: Tell) -> None:
        self.pipeline = Pipeline(begun, begun.folder)
        self.runs: list[Run] = []
        self.scenes: dict[tuple[str, int], Scene] = {}
        self.decisions: dict[str, Decisions] = {}
        self.plan = ""
        self.said: Sequence[Finished] = ()
        self._running = ExitStack()
        self._begun = begun
        self._wanted = wanted
        self._tell = tell

    def runs_of(self, case: str, seed: int) -> Runs:
        """Return the runs of a case in one world, by variant."""
        found = (run for run in self.runs if (run.case, run.seed) == (case, seed))
        return {run.variant: run for run in found}

    def risks(self) -> Sequence[Risk]:
        """Return the risks that the scan found, in the order of kinds."""
        return discover(GraphFile(self.pipeline.graph).read()).risks

    def unguarded(self) -> None:
        """Scan the app and run it as it is: each case in each world, without and with an attack.

        SourceError if something that it needs has ended or does not answer.
        """
        self._tell.now("rtron scan: who can interfere with whom?")
        self.pipeline.scan()
        self.said = tuple(self.pipeline.said)
        self._tell.now("starting the app as it is")
        with self._begun.launched(launch_file(self._begun.ros)) as app:
            session = Session(self._begun, app, self._wanted.camera_rate)
            session.wait_until_connected()
            for case in self._wanted.cases:
                for seed in self._wanted.seeds:
                    for variant in _UNGUARDED:
                        self._keep(self._run(session, case, seed, variant))

    def guarded(self, service: Service | None = None) -> None:
        """Run the guarded app: each case in each world, attacked. To be called after `unguarded`.

        With a service the guard's decisions are recorded, and become part of the runs; it gets the
        app's graph, too.
        """
        with self.guarding(service):
            pass

    @contextmanager
    def guarding(self, service: Service | None = None) -> Iterator[None]:
        """Do what `guarded` does; the last guarded app runs on until the end of the block."""
        wanted = self._wanted
        if service:
            service.wait()
        with self._running:
            for decisions, seeds in by_decisions(wanted.cases, wanted.seeds, self._setting):
                self._guarded(decisions, seeds, service)
            yield

    def _setting(self, case: Case, seed: int) -> Setting:
        """Return what decisions of a case may depend on, in a world that was run before."""
        scene, speed = self.scenes[case.name, seed], self._begun.speed
        return Setting(scene=scene, speed=speed, rate=self._wanted.camera_rate)

    def _guarded(self, decisions: Decisions, seeds: Sequence[int], service: Service | None) -> None:
        self._running.close()
        launch = self._instrumented(decisions)
        began = time.time_ns()
        session = self._launched(launch, service.environ() if service else None)
        cases = [(case, seed) for case in self._wanted.cases for seed in seeds]
        runs = [(case, self._run(session, case, seed, Variant.GUARDED)) for case, seed in cases]
        events: Sequence[Event] = ()
        if service:
            events = service.recorded.events(began, time.time_ns() + _COUNTED)
            service.upload(self.pipeline.graph)
        for case, run in runs:
            self._keep(with_verdicts(run, case, events, self.pipeline.plan))

    def _instrumented(self, decisions: Decisions) -> Path:
        """Return the launch file of an app that is guarded by what was decided."""
        self._tell.now("rtron plan, check, instrument: what should stand in between?")
        launch = self.pipeline.guard({"app": NAME, **decisions})
        if not self.decisions:
            self.said = tuple(self.pipeline.said)
            self.plan = self.pipeline.plan.read_text(encoding="utf-8")
            for case in self._wanted.cases:
                setting = self._setting(case, self._wanted.seeds[0])
                self.decisions[case.name] = case.decisions(setting)
        return launch

    def _launched(self, launch: Path, more: Mapping[str, str] | None) -> Session:
        """Start a guarded app, which runs until the next one does."""
        self._tell.now("starting the guarded app")
        app = self._begun.launched(launch, more, self.pipeline.plan)
        session = Session(self._begun, self._running.enter_context(app), self._wanted.camera_rate)
        session.wait_until_connected()
        return session

    def _run(self, session: Session, case: Case, seed: int, variant: Variant) -> Run:
        self._tell.now(f"{case.name}, world {seed}: {variant}")
        scene, run = session.run(case, seed, variant)
        self.scenes[case.name, seed] = scene
        return run

    def _keep(self, run: Run) -> None:
        """Keep a run with how far it is from the unattacked one, which came before it."""
        calm = self.runs_of(run.case, run.seed).get(Variant.UNATTACKED)
        off = deviation(way(run.samples), way(calm.samples)) if calm else None
        kept = replace(run, deviation=off)
        self.runs.append(kept)
        self._tell.done(kept)
