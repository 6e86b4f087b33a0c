"""Compares a guarded launch with its original, both as ROS's own loader gives them."""

from fnmatch import fnmatchcase
from itertools import product

from roslaunch_oracle import ANONYMOUS

from rtron.vocabulary import Mode

GUARD = "/rtron_guard"


def split_guard(dump):
    """Return the guard's node and the dump without it."""
    guards = [node for node in dump["nodes"] if node["full_name"] == GUARD]
    others = [node for node in dump["nodes"] if node["full_name"] != GUARD]
    (guard,) = guards
    return guard, {**dump, "nodes": others}


def without_remaps(dump):
    """Return all that guarding must leave as it is."""
    own = {"remap_args", "resolved_remaps"}
    nodes = [{k: v for k, v in node.items() if k not in own} for node in nodes_of(dump)]
    kept = ("params", "clear_params", "machines", "executables")
    return {"nodes": nodes} | {key: dump[key] for key in kept}


def nodes_of(dump):
    return [*dump["nodes"], *dump["tests"]]


def remapped_name(node, name, order):
    """Return where a resolved name leads at a node; clients read remaps in one of two orders."""
    pairs = node["resolved_remaps"]
    if order == "roscpp":  # goes through a map, sorted by what is written
        written = [pair[0] for pair in node["remap_args"]]
        pairs = [pair for _, pair in sorted(zip(written, pairs, strict=True))]
    return dict(map(tuple, pairs)).get(name, name)


def private_topic(plan, node, topic):
    """Return where a node's `topic` must lead in the guarded launch; itself if not guarded."""
    enforced = [s for s in plan.grcn if s.topic == topic and s.mode is Mode.ENFORCE]
    for stream, name in product(enforced, names_of(node)):
        flows = [flow for flow in stream.flows if meant(flow.publisher, name)]
        if flows:
            return f"/rtron{topic}/{flows[0].name}"
        if any(meant(successor, name) for successor in stream.successors):
            return f"/rtron{topic}/out"
    return topic


def names_of(node):
    """Return a node's name, and that of the manager which a nodelet is loaded into."""
    namespace, *words = node["namespace"], *node["args"].split()
    loads = node["package"] == "nodelet" and words[0] == "load"
    names = [node["full_name"], namespace + words[2]] if loads else [node["full_name"]]
    return [name.replace(ANONYMOUS, "_*") for name in names]


def meant(pattern, name):
    return pattern == name or fnmatchcase(name, pattern)


def assert_guarded(original, guarded, plan, names):
    """Assert that only names which led to a guarded topic lead elsewhere, and where they should."""
    assert "error" not in original, original
    assert "error" not in guarded, guarded
    guard, guarded = split_guard(guarded)
    assert guard["remap_args"] == [], "the guard inherits remaps"
    assert guarded["nodes"] + guarded["tests"] or not original["nodes"] + original["tests"]
    assert without_remaps(guarded) == without_remaps(original)
    for before, after in zip(nodes_of(original), nodes_of(guarded), strict=True):
        declared = {pair[0] for pair in before["resolved_remaps"]} | set(names)
        for name in declared:
            for order in ("rospy", "roscpp"):
                led = remapped_name(before, name, order)
                expected = private_topic(plan, before, led)
                assert remapped_name(after, name, order) == expected, (
                    before["full_name"],
                    name,
                    order,
                )
