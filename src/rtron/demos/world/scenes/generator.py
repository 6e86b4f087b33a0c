"""The scene of a case and a seed: the same two make the same scene, on every machine."""

from collections.abc import Callable
from random import Random

from rtron.demos.world.corridor import corridor
from rtron.demos.world.placement import placed
from rtron.demos.world.scenes.network_outage import unstable
from rtron.demos.world.scenes.scene import Scene
from rtron.demos.world.scenes.street import street

_DRAWN: dict[str, Callable[[int, Random], Scene]] = {
    "gr": corridor,
    "rsr": street,
    "msr": unstable,
}


def make_scene(case: str, seed: int) -> Scene:
    """Return the scene of a case ("gr", "rsr" or "msr") and a seed; KeyError for another case."""
    chance = Random(f"{case} {seed}")  # noqa: S311 - a world, no secret
    return placed(_DRAWN[case](seed, chance), chance)
