"""The world: one robot in one scene at a time, in steps of simulated time. It knows no sockets."""

from math import dist

import shapely
from shapely import LineString, Point, Polygon

from rtron.demos.world import camera, lidar, robot_base, shapes
from rtron.demos.world.command import STILL, Command
from rtron.demos.world.ground_truth import Place, Truth
from rtron.demos.world.irsim_backend import Simulator
from rtron.demos.world.pedestrian import Pedestrian
from rtron.demos.world.ray_casting import surfaces
from rtron.demos.world.scenes.generator import make_scene
from rtron.demos.world.scenes.scene import Scene
from rtron.demos.world.server.requests import Reset


class World:
    """Starts in run 0, in which the robot may be driven about; each reset begins the next run.

    From a reset to the start the robot's brake is on: what the last run's nodes still say does not
    move it. A collision holds the robot until the next reset, the area without network as well.
    """

    def __init__(self) -> None:
        self.run = -1
        self.steps = 0
        self._started: float | None = None
        self._set(Reset("gr", 0))
        self._brake = False

    @property
    def t(self) -> float:
        """Simulated s since the world began."""
        return round(self.steps * robot_base.STEP, 6)

    def reset(self, order: Reset) -> None:
        """Begin the next run: the robot at the start of a scene, and still."""
        self._set(order)

    def start(self) -> None:
        """Release the brake; the light's time begins."""
        self._brake = False
        self._started = self.t

    def command(self, velocity: robot_base.Velocity, share: float) -> None:
        """Take a velocity (m/s, rad/s) that came when `share` (0 to 1) of the step had passed."""
        self._command.take(velocity, share)

    def step(self) -> None:
        """Go on by a step: the people, the robot, and what became of it."""
        for pedestrian in self._pedestrians:
            pedestrian.step(robot_base.STEP, self._robot)
        wanted = self._command.mean()
        stays = self._brake or self.collided or not self.network
        people = [pedestrian.place for pedestrian in self._pedestrians]
        self._simulator.step(STILL if stays else wanted, people)
        self.steps += 1
        self._suffer()

    @property
    def light(self) -> str:
        """What the light shows: "red" or "green", or "none" where there is no light."""
        if self.scene.light is None:
            return "none"
        since = self.t - (self.t if self._started is None else self._started)
        return "green" if since >= self.scene.green_after else "red"

    @property
    def people(self) -> tuple[Place, ...]:
        """Where people are now."""
        places = [pedestrian.place for pedestrian in self._pedestrians]
        return tuple(place for place in places if place is not None)

    def truth(self) -> Truth:
        """Return all that is true now."""
        pose = self._simulator.pose
        return Truth(
            t=self.t,
            run=self.run,
            pose=pose,
            velocity=self._simulator.velocity,
            commanded=self._command.held,
            clearance=self._clearance(),
            collided=self.collided,
            in_area=self.in_area,
            network=self.network,
            light=self.light,
            pedestrians=self.people,
            distance_to_goal=dist(self._robot, self.scene.goal),
        )

    def motion(self) -> tuple[tuple[float, ...], robot_base.Velocity]:
        """Return the robot's pose (m, m, rad) and velocity (m/s, rad/s)."""
        return self._simulator.pose, self._simulator.velocity

    def scan(self) -> bytes:
        """Return what the laser scanner measures now."""
        seen = self._surfaces.with_discs(self.people, robot_base.PEDESTRIAN_RADIUS)
        return lidar.scan(seen, self._simulator.pose)

    def picture(self) -> bytes:
        """Return what the camera sees now, rgb8."""
        lamp = (self.scene.light, self.light) if self.scene.light else None
        walls, pose = len(self.scene.walls), self._simulator.pose
        return camera.image(self._surfaces, walls, pose, self.people, lamp).tobytes()

    @property
    def _robot(self) -> Place:
        x, y, _ = self._simulator.pose
        return x, y

    def _set(self, order: Reset) -> None:
        scene = make_scene(order.case, order.seed)
        self._place(scene)
        self.run += 1
        self.camera_rate = order.camera_rate
        self.collided = self.in_area = False
        self.network = True
        self._brake = True
        self._started = None

    def _place(self, scene: Scene) -> None:
        self.scene = scene
        self._simulator = Simulator(scene)
        self._command = Command()
        self._surfaces = surfaces(scene)
        self._solid = shapes.solid(scene)
        self._area = Polygon(scene.area) if scene.area else Polygon()
        way = LineString(scene.route)
        self._pedestrians = [Pedestrian(each, way, scene.goal) for each in scene.crossings]

    def _suffer(self) -> None:
        if self._simulator.collided and not self.collided:
            self.collided = True
            self._simulator.halt()
        self.in_area = bool(self._area.contains(Point(self._robot)))
        self.network = not self.in_area

    def _clearance(self) -> float:
        """Return the free space around the robot's body, m; 0 where it touches something."""
        around = float(shapely.distance(self._solid, Point(self._robot)))
        others = [dist(self._robot, place) - robot_base.PEDESTRIAN_RADIUS for place in self.people]
        return max(0.0, min(around, *others, float("inf")) - robot_base.RADIUS)
