"""The world: one robot in one scene at a time, in steps of simulated time. It knows no sockets."""

from dataclasses import dataclass
from enum import Enum
from math import dist

import shapely
from shapely import LineString, Point, Polygon

from rtron.demos.world import camera, ray_casting, robot_base
from rtron.demos.world.ground_truth import GroundTruth, Position
from rtron.demos.world.irsim_backend import IrSimBackend
from rtron.demos.world.ray_casting import scene_surfaces
from rtron.demos.world.robot_base import ZERO_VELOCITY, VelocityCommand
from rtron.demos.world.scenes import geometry
from rtron.demos.world.scenes.generator import make_scene
from rtron.demos.world.scenes.scene import Crossing, Scene

CAMERA_RATE = 10.0
"""Images a simulated second, if nobody asks for another rate."""


class RobotSimulation:
    """Starts in run 0, in which the robot may be driven about; each reset begins the next run.

    From a reset to the start the robot's brake is on: what the last run's nodes still say does not
    move it. A collision holds the robot until the next reset, the area without network as well.
    """

    def __init__(self) -> None:
        self.run = -1
        self.steps = 0
        self._started: float | None = None
        self.reset("gr", 0)
        self._is_braked = False

    @property
    def t(self) -> float:
        """Simulated s since the world began."""
        return round(self.steps * robot_base.STEP, 6)

    def reset(self, case: str, seed: int, camera_rate: float = CAMERA_RATE) -> None:
        """Begin the next run: the robot at the start of the scene of a case and seed, and still."""
        self._load_scene(make_scene(case, seed))
        self.run += 1
        self.camera_rate = camera_rate
        self.collided = self.in_area = False
        self._is_braked = True
        self._started = None

    def start(self) -> None:
        """Release the brake; the light's time begins."""
        self._is_braked = False
        self._started = self.t

    def set_velocity(self, velocity: robot_base.Velocity, step_fraction: float) -> None:
        """Take a velocity (m/s, rad/s) that came at `step_fraction` (0 to 1) of the step."""
        self._command.set_velocity(velocity, step_fraction)

    def step(self) -> None:
        """Go on by a step: the people, the robot, and what became of it."""
        for pedestrian in self._pedestrians:
            pedestrian.step(robot_base.STEP, self._robot)
        target_velocity = self._command.end_step()
        stays = self._is_braked or self.collided or self.in_area
        people = [pedestrian.position for pedestrian in self._pedestrians]
        self._simulator.step(ZERO_VELOCITY if stays else target_velocity, people)
        self.steps += 1
        self._update_outcome()

    @property
    def light(self) -> str:
        """What the light shows: "red" or "green", or "none" where there is no light."""
        if self.scene.light is None:
            return "none"
        since = self.t - (self.t if self._started is None else self._started)
        return "green" if since >= self.scene.green_after else "red"

    @property
    def people(self) -> tuple[Position, ...]:
        """Where people are now."""
        positions = [pedestrian.position for pedestrian in self._pedestrians]
        return tuple(position for position in positions if position is not None)

    def truth(self) -> GroundTruth:
        """Return all that is true now."""
        pose = self._simulator.pose
        return GroundTruth(
            t=self.t,
            run=self.run,
            pose=pose,
            velocity=self._simulator.velocity,
            commanded=self._command.velocity,
            clearance=self._clearance(),
            collided=self.collided,
            in_area=self.in_area,
            light=self.light,
            pedestrians=self.people,
            distance_to_goal=dist(self._robot, self.scene.goal),
        )

    def motion(self) -> tuple[tuple[float, ...], robot_base.Velocity]:
        """Return the robot's pose (m, m, rad) and velocity (m/s, rad/s)."""
        return self._simulator.pose, self._simulator.velocity

    def lidar_scan(self) -> bytes:
        """Return what the laser scanner measures now."""
        visible = self._surfaces.with_discs(self.people, robot_base.PEDESTRIAN_RADIUS)
        return ray_casting.scan(visible, self._simulator.pose)

    def camera_image(self) -> bytes:
        """Return what the camera sees now, rgb8."""
        lamp = (self.scene.light, self.light) if self.scene.light else None
        walls, pose = len(self.scene.walls), self._simulator.pose
        return camera.render_image(self._surfaces, walls, pose, self.people, lamp).tobytes()

    @property
    def _robot(self) -> Position:
        x, y, _ = self._simulator.pose
        return x, y

    def _load_scene(self, scene: Scene) -> None:
        self.scene = scene
        self._simulator = IrSimBackend(scene)
        self._command = VelocityCommand()
        self._surfaces = scene_surfaces(scene)
        self._solid = geometry.solid_area(scene)
        self._area = Polygon(scene.area) if scene.area else Polygon()
        path = LineString(scene.route)
        self._pedestrians = [Pedestrian(each, path, scene.goal) for each in scene.crossings]

    def _update_outcome(self) -> None:
        if self._simulator.collided and not self.collided:
            self.collided = True
            self._simulator.halt()
        self.in_area = bool(self._area.contains(Point(self._robot)))

    def _clearance(self) -> float:
        """Return the free space around the robot's body, m; 0 where it touches something."""
        around = float(shapely.distance(self._solid, Point(self._robot)))
        others = [
            dist(self._robot, position) - robot_base.PEDESTRIAN_RADIUS for position in self.people
        ]
        return max(0.0, min(around, *others, float("inf")) - robot_base.RADIUS)


_NEAREST, _BEYOND = 0.6, 0.25
"""How far from the nominal place a pedestrian may stand: this share of the walk, and m."""


class WalkPhase(Enum):
    """Where in the walk a pedestrian is."""

    HIDDEN = "before"
    APPROACHING = "coming"
    PAUSING = "standing"
    RETURNING = "leaving"
    DONE = "gone"


@dataclass(slots=True)
class Pedestrian:
    """A walk that happens once a run."""

    crossing: Crossing
    route: LineString
    goal: Position
    phase: WalkPhase = WalkPhase.HIDDEN
    walked: float = 0.0
    """m from the door."""
    target_distance: float = 0.0
    """m from the door to where the pedestrian will stand."""
    paused: float = 0.0
    """s."""

    @property
    def position(self) -> Position | None:
        """Where the pedestrian is; None before and after the walk."""
        if self.phase in {WalkPhase.HIDDEN, WalkPhase.DONE}:
            return None
        share = self.walked / self._length
        (ax, ay), (bx, by) = self.crossing.start, self.crossing.stand
        return ax + share * (bx - ax), ay + share * (by - ay)

    def step(self, seconds: float, robot: Position) -> None:
        """Live on for some seconds, with the robot at a place."""
        if self.phase is WalkPhase.HIDDEN:
            self._check_start(robot)
        elif self.phase is WalkPhase.APPROACHING:
            self._walk(seconds)
        elif self.phase is WalkPhase.PAUSING:
            self._pause(seconds)
        elif self.phase is WalkPhase.RETURNING:
            self._walk(-seconds)

    @property
    def _length(self) -> float:
        return dist(self.crossing.start, self.crossing.stand)

    def _check_start(self, robot: Position) -> None:
        robot_progress = self.route.project(Point(robot))
        stand_progress = self.route.project(Point(self.crossing.stand))
        if stand_progress - self.crossing.trigger_distance <= robot_progress < stand_progress:
            self.target_distance = self._crossing_distance(robot)
            self.phase = WalkPhase.APPROACHING

    def _walk(self, seconds: float) -> None:
        self.walked += self.crossing.pace * seconds
        if self.walked >= self.target_distance:
            self.walked, self.phase = self.target_distance, WalkPhase.PAUSING
        elif self.walked <= 0.0:
            self.phase = WalkPhase.DONE

    def _pause(self, seconds: float) -> None:
        self.paused += seconds
        if self.paused >= self.crossing.pause:
            self.phase = WalkPhase.RETURNING

    def _crossing_distance(self, robot: Position) -> float:
        """Return how far it is to where the walk crosses the robot's line to its goal, m."""
        (dx, dy), (sx, sy) = self.crossing.start, self.crossing.stand
        gx, gy = self.goal[0] - robot[0], self.goal[1] - robot[1]
        along = gx * (sy - dy) - gy * (sx - dx)
        away = gy * (dx - robot[0]) - gx * (dy - robot[1])
        distance = self._length * (away / along if along else 1.0)
        return max(_NEAREST * self._length, min(self._length + _BEYOND, distance))
