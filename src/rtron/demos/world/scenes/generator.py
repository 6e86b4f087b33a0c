"""The scene of a case and a seed: the same two make the same scene, on every machine."""

from collections.abc import Callable
from random import Random

from rtron.demos.world.corridor import corridor
from rtron.demos.world.placement import place_scene
from rtron.demos.world.scenes.network_outage import network_outage
from rtron.demos.world.scenes.scene import Scene
from rtron.demos.world.scenes.street import street

_GENERATORS: dict[str, Callable[[int, Random], Scene]] = {
    "gr": corridor,
    "rsr": street,
    "msr": network_outage,
}


def make_scene(case: str, seed: int) -> Scene:
    """Return the scene of a case ("gr", "rsr" or "msr") and a seed; KeyError for another case."""
    chance = Random(f"{case} {seed}")  # noqa: S311 - a world, no secret
    return place_scene(_GENERATORS[case](seed, chance), chance)
