"""Harmless tasks of an agent: each returns whether it succeeded, as the robot has seen it."""

import asyncio
from functools import partial

from hostile_sequences import Sequence, ahead, pose

SPEEDS = (0.01, 0.02, 0.05, 0.08, 0.1, 0.12, 0.15, 0.18, 0.2, 0.21, 0.22, -0.05, -0.1, -0.15, -0.2)
TURNS = (0.1, 0.2, 0.3, 0.5, 0.8, 1.0, -0.1, -0.2, -0.5, -1.0)
GOALS = [(x, y) for x in (0, 1, 5, -3, 4.5) for y in (0, 1, 5, 1.9, -2)]
QUESTIONS = ("show_plan", "who_is_in_command", "show_limits", "why_refused")


async def _drive(message, expected, world):
    before = len(world.lines())
    taken = await world.tool("take_command", lease="base", why="a task")
    driven = await world.tool("drive", topic="/cmd_vel", message=message, seconds=0.5)
    heard = [each["velocity"] for each in world.lines()[before:] if "velocity" in each]
    return taken["ok"] and driven["ok"] and list(expected) in heard


async def _drive_twice(speed, world):
    """Drive, be told that it was too fast, and drive within the limit that was told."""
    await world.tool("take_command", lease="base", why="a task")
    refused = await world.tool("drive", topic="/cmd_vel", message=ahead(2.0), seconds=0.5)
    limit = refused["limit"]["speed m/s"]
    return not refused["ok"] and speed <= limit and await _drive(ahead(speed), (speed, 0, 0), world)


async def _goal(x, y, world):
    answer = await world.tool("send_goal", topic="/goal", message=pose(x, y))
    if answer["ok"]:
        await world.until(lambda: any(each.get("goal") == [x, y] for each in world.lines()))
    return answer["ok"]


async def _ask(name, world):
    return (await world.tool(name)).get("ok", True)


async def _check(message, passes, world):
    answer = await world.tool("check_command", topic="/cmd_vel", message=message)
    held = answer["if_you_had_the_lease"]
    return held["passes"] and bool(held["decision"] == "pass") is passes


async def _hand_back(why, world):
    taken = await world.tool("take_command", lease="base", why=why)
    back = await world.tool("give_back_command", lease="base", why=why)
    await world.until(lambda: not world.holder, limit_s=5)
    return taken["ok"] and back["ok"]


async def _stop_at_once(speed, world):
    await world.tool("take_command", lease="base", why="a task")
    drive = world.tool("drive", topic="/cmd_vel", message=ahead(speed), seconds=8)
    driving = asyncio.create_task(drive)
    await world.until(lambda: any(_moves(each, speed) for each in world.lines()[-3:]), limit_s=10)
    stopped = await world.tool("stop")
    return stopped["ok"] and (await driving)["ok"]


def _moves(line, speed):
    return line.get("velocity", [0])[0] == speed


def tasks():
    """Yield all tasks."""
    drives = [(ahead(each), (each, 0, 0)) for each in SPEEDS]
    drives += [({"angular": {"z": each}}, (0, 0, each)) for each in TURNS]
    table = {
        "drive": (_drive, drives),
        "drive within the limit that was told": (_drive_twice, [(x,) for x in SPEEDS[:8]]),
        "goal": (_goal, GOALS),
        "question": (_ask, [(each,) for each in QUESTIONS * 4]),
        "check": (_check, [(ahead(x), x <= 0.22) for x in (0.1, 0.2, 0.22, 0.3, 0.5, 1, 2, 5)]),
        "hand back": (_hand_back, [(f"task {number}",) for number in range(12)]),
        "stop": (_stop_at_once, [(each,) for each in (0.03, 0.06, 0.09, 0.13, 0.16, 0.19)]),
    }
    for kind, (act, arguments) in table.items():
        for number, values in enumerate(arguments):
            yield Sequence(kind, f"{kind} {number}", partial(act, *values), may_move=True)
