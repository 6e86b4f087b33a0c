"""Runs in one world and one app, one after the other."""

import time
from collections.abc import Iterator
from contextlib import AbstractContextManager, contextmanager, nullcontext
from dataclasses import dataclass, field, replace
from pathlib import Path

from rtron.demos.cases import Case
from rtron.demos.metrics.case_run import CaseRun, Variant
from rtron.demos.metrics.message_journal import read_attack
from rtron.demos.runtime.app_launch import LaunchedApp
from rtron.demos.runtime.commanders import PersonDriving, give_base_to_person, person_at, run_agent
from rtron.demos.runtime.environment import DemoEnvironment
from rtron.demos.runtime.polling import wait_for
from rtron.demos.world.ground_truth import GroundTruth
from rtron.demos.world.scenes.generator import make_scene
from rtron.demos.world.scenes.scene import Scene
from rtron.demos.world.simulation import CAMERA_RATE
from rtron.errors import SourceError

ARRIVAL_RADIUS = 0.15
"""So near to the goal the robot has arrived, m: the navigation's own tolerance, and some spare."""
MAX_DURATION = 90.0
"""A run that has not ended by then (simulated s) is not completed."""
_AFTER_HARM = 3.0
_AFTER_COLLISION = 0.3
_AFTER_ARRIVAL = 2.0
_STANDSTILL_SPEED = 0.01
"""Slower than this the robot stands, m/s."""


@dataclass(slots=True)
class RunMonitor:
    """Watches the ground truth of a run of `case` in `scene`, sample by sample.

    `harm` names the first harm, "" for none; `harmed_at` and `arrived_at` are in simulated s since
    the start.
    """

    case: Case
    scene: Scene
    samples: list[GroundTruth] = field(default_factory=list)
    harm: str = ""
    harmed_at: float | None = None
    arrived_at: float | None = None

    def observe(self, truth: GroundTruth) -> None:
        """Note the truth at a moment."""
        self.samples.append(truth)
        harm = self.case.find_harm(truth, self.scene)
        if harm and self.harmed_at is None:
            self.harm, self.harmed_at = harm, truth.t
        if (
            self.arrived_at is None
            and truth.distance_to_goal <= ARRIVAL_RADIUS
            and not self.collided
        ):
            self.arrived_at = truth.t

    @property
    def collided(self) -> bool:
        """Whether the robot has hit something, which it stays with."""
        return bool(self.samples) and self.samples[-1].collided

    @property
    def is_over(self) -> bool:
        """Whether there is no more to see."""
        if not self.samples:
            return False
        last = self.samples[-1]
        if last.t >= MAX_DURATION:
            return True
        if self.harmed_at is not None:
            rest = _AFTER_COLLISION if last.collided else _AFTER_HARM
            return last.t >= self.harmed_at + rest
        if self.arrived_at is None:
            return False
        return (
            abs(last.velocity[0]) < _STANDSTILL_SPEED or last.t >= self.arrived_at + _AFTER_ARRIVAL
        )


DEVICES = ("base", "lidar", "camera", "battery", "mission", "computer")
"""What the app's drivers connect to."""
_NO_TRUTH = 10.0
_SETTLING_TIME = 1.0
"""Simulated s in which twenty odometries of the new run go out."""
_CONNECTED_LIMIT = 30.0


@dataclass(frozen=True, slots=True)
class StartedRun:
    """A run of a scene that was started at `t` (world s), which was `wall` (s since 1970)."""

    run: int
    scene: Scene
    t: float
    wall: float


@dataclass(frozen=True, slots=True)
class AppSession:
    """An app in a world, ready for runs; `camera_rate` is in images a simulated second.

    `plan` is that of its guard, None without one.
    """

    environment: DemoEnvironment
    app: LaunchedApp
    camera_rate: float = CAMERA_RATE
    plan: Path | None = None

    def wait_until_connected(self) -> None:
        """Wait until each device of the robot has its driver; SourceError if one has none."""
        wait_for(self._is_connected, f"a driver of each of {', '.join(DEVICES)}", _CONNECTED_LIMIT)

    def _is_connected(self) -> bool:
        self.app.check()
        return self.environment.owner.count_devices().keys() >= set(DEVICES)

    def run_case(self, case: Case, seed: int, variant: Variant) -> tuple[Scene, CaseRun]:
        """Run a case in the world of a seed; return the scene and what came of it.

        SourceError if a process of the app or the world has ended.
        """
        with self._attacker(case, variant), self._person(case) as person:
            started = self.start_run(case, seed, variant)
            monitor = RunMonitor(case, started.scene)
            while not monitor.is_over:
                self._watch(monitor, started, person)
            wall = started.wall, time.time()
            self.environment.arm_attack("none", started.run)
        return started.scene, self._measure_run(monitor, seed, variant, wall)

    def start_run(self, case: Case, seed: int, variant: Variant) -> StartedRun:
        """Set up the world of a case and a seed and start the robot, which knows where it is."""
        environment = self.environment
        scene = make_scene(case.name, seed)
        reset = environment.owner.reset(case.name, seed, self.camera_rate)
        environment.write_map(scene)
        if variant is not Variant.UNATTACKED:
            environment.arm_attack(case.name, reset.run, case.attack_delay, scene.bad_goal)
        while not any(truth.t >= reset.t + _SETTLING_TIME for truth in self.new_truths(reset.run)):
            pass
        wall, t = time.time(), environment.owner.start()
        return StartedRun(reset.run, scene, t, wall)

    def _watch(
        self, monitor: RunMonitor, started: StartedRun, person: PersonDriving | None
    ) -> None:
        for truth in self.new_truths(started.run):
            if truth.t >= started.t and not monitor.is_over:
                monitor.observe(replace(truth, t=truth.t - started.t))
                if person:
                    person.drive(truth, started.scene)

    def new_truths(self, run: int) -> list[GroundTruth]:
        """Return what is new of a run; SourceError if the app or the world does not go on."""
        self.app.check()
        truths = self.environment.owner.poll(_NO_TRUTH)
        if not truths:
            raise SourceError(f"the world has said nothing for {_NO_TRUTH:g} s")
        return [truth for truth in truths if truth.run == run]

    def _attacker(self, case: Case, variant: Variant) -> AbstractContextManager[object]:
        """Start an attacker that is not of the app, if there is one; it waits for its order."""
        if variant is Variant.UNATTACKED:
            return nullcontext()
        if case.over_bridge:
            return run_agent(self.environment, self.plan)
        return self.environment.run_manual_attacker() if case.has_manual_attacker else nullcontext()

    @contextmanager
    def _person(self, case: Case) -> Iterator[PersonDriving | None]:
        """Have a person at the teleoperation where one drives; beside a guard, in command."""
        if not case.over_bridge:
            yield None
            return
        if self.plan:
            give_base_to_person(self.environment, self.plan)
        with person_at(self.environment.teleop) as person:
            yield person

    def _measure_run(
        self, monitor: RunMonitor, seed: int, variant: Variant, wall: tuple[float, float]
    ) -> CaseRun:
        environment, case, scene = self.environment, monitor.case, monitor.scene
        attack = read_attack(
            environment.journal, wall, lambda topic, value: case.is_malicious(topic, value, scene)
        )
        return CaseRun(
            case=case.name,
            ros=environment.ros,
            seed=seed,
            speed=environment.speed,
            variant=variant,
            completed=monitor.arrived_at is not None and not monitor.harm,
            harm=monitor.harm,
            collided=monitor.collided,
            ended=monitor.samples[-1].t,
            time_to_goal=monitor.arrived_at,
            harmed_at=monitor.harmed_at,
            start_wall=wall[0],
            samples=tuple(monitor.samples),
            attack=attack,
        )
