"""Runs in one world and one app, one after the other."""

import time
from contextlib import AbstractContextManager, nullcontext
from dataclasses import dataclass

from rtron.demos.cases import Case
from rtron.demos.experiment.run_monitor import Judge
from rtron.demos.metrics.case_run import Run, Variant
from rtron.demos.metrics.message_journal import attack, read_journal
from rtron.demos.metrics.trajectory import Scene, since
from rtron.demos.runtime.app_launch import App
from rtron.demos.runtime.environment import Begun
from rtron.demos.world.ground_truth import Truth
from rtron.errors import SourceError

DEVICES = ("base", "lidar", "camera", "battery", "mission", "computer")
"""What the app's drivers connect to."""
_NO_TRUTH = 10.0
_SETTLING = 1.0
"""Simulated s in which twenty odometries of the new run go out."""
_CONNECTED_LIMIT = 30.0
_PAUSE = 0.05


@dataclass(frozen=True, slots=True)
class Started:
    """A run of a scene that was started at `t` (world s), which was `wall` (s since 1970)."""

    run: int
    scene: Scene
    t: float
    wall: float


@dataclass(frozen=True, slots=True)
class Session:
    """An app in a world, ready for runs; `camera_rate` is in images a simulated second."""

    begun: Begun
    app: App
    camera_rate: float = 10.0

    def wait_until_connected(self) -> None:
        """Wait until each device of the robot has its driver; SourceError if one has none."""
        until = time.monotonic() + _CONNECTED_LIMIT
        while absent := [name for name in DEVICES if not self.begun.owner.devices().get(name)]:
            self.app.check()
            if time.monotonic() > until:
                raise SourceError(f"no driver has connected to {', '.join(absent)}")
            time.sleep(_PAUSE)

    def run(self, case: Case, seed: int, variant: Variant) -> tuple[Scene, Run]:
        """Run a case in the world of a seed; return the scene and what came of it.

        SourceError if a process of the app or the world has ended.
        """
        with self._by_hand(case, variant):
            started = self.start(case, seed, variant)
            judge = Judge(case, started.scene)
            while not judge.is_over:
                self._watch(judge, started)
            wall = started.wall, time.time()
            self.begun.arm("none", started.run)
        return started.scene, self._told(judge, seed, variant, wall)

    def start(self, case: Case, seed: int, variant: Variant) -> Started:
        """Set up the world of a case and a seed and start the robot, which knows where it is."""
        begun = self.begun
        reset = begun.owner.reset(case.name, seed, self.camera_rate)
        begun.show_map(reset.scene)
        if variant is not Variant.UNATTACKED:
            begun.arm(case.name, reset.run, case.after, reset.scene["bad_goal"])
        while not any(truth.t >= reset.t + _SETTLING for truth in self.truths(reset.run)):
            pass
        wall, t = time.time(), begun.owner.start()
        return Started(reset.run, reset.scene, t, wall)

    def _watch(self, judge: Judge, started: Started) -> None:
        for truth in self.truths(started.run):
            if truth.t >= started.t and not judge.is_over:
                judge.take(since(started.t, truth))

    def truths(self, run: int) -> list[Truth]:
        """Return what is new of a run; SourceError if the app or the world does not go on."""
        self.app.check()
        truths = self.begun.owner.poll(_NO_TRUTH)
        if not truths:
            raise SourceError(f"the world has said nothing for {_NO_TRUTH:g} s")
        return [truth for truth in truths if truth.run == run]

    def _by_hand(self, case: Case, variant: Variant) -> AbstractContextManager[object]:
        """Start the second attacker, which like the first waits for its order, if there is one."""
        wanted = case.by_hand and variant is not Variant.UNATTACKED
        return self.begun.by_hand() if wanted else nullcontext()

    def _told(self, judge: Judge, seed: int, variant: Variant, wall: tuple[float, float]) -> Run:
        begun, case, scene = self.begun, judge.case, judge.scene
        entries = read_journal(begun.journal, *wall)
        messages = attack(entries, lambda topic, value: case.is_malicious(topic, value, scene))
        return Run(
            case=case.name,
            ros=begun.ros,
            seed=seed,
            speed=begun.speed,
            variant=variant,
            completed=judge.arrived_at is not None and not judge.harm,
            harm=judge.harm,
            collided=judge.collided,
            ended=judge.samples[-1].t,
            time_to_goal=judge.arrived_at,
            harmed_at=judge.harmed_at,
            began_wall=wall[0],
            samples=tuple(judge.samples),
            attack=messages,
        )
