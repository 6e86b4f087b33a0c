"""The XML of behaviour trees: which nodes a tree has, and their ports (behaviortree.dev)."""

from collections.abc import Iterator
from dataclasses import dataclass

from rtron.errors import InputError
from rtron.sources.launch.common.xml_document import Element, line_of, parse_xml_bytes

MAX_NODES = 2000
BUILT_IN_NODES = frozenset(
    {
        *("Sequence", "AsyncSequence", "ReactiveSequence", "SequenceWithMemory", "SequenceStar"),
        *("Fallback", "AsyncFallback", "ReactiveFallback", "Parallel", "ParallelAll", "TryCatch"),
        *("IfThenElse", "WhileDoElse", "Inverter", "ForceSuccess", "ForceFailure", "Repeat"),
        *("RetryUntilSuccessful", "RetryUntilSuccesful", "KeepRunningUntilFailure", "Delay"),
        *("RunOnce", "Timeout", "Precondition", "AlwaysSuccess", "AlwaysFailure", "Script"),
        *("ScriptCondition", "SetBlackboard", "UnsetBlackboard", "Sleep", "WasEntryUpdated"),
        *("SkipUnlessUpdated", "WaitValueUpdate", "EntryUpdated", "SubTree", "SubTreePlus"),
        *("LoopInt", "LoopBool", "LoopDouble", "LoopString", "ManualSelector", "BlackboardCheck"),
        *(f"Switch{count}" for count in range(2, 7)),
    }
)
"""The nodes of BehaviorTree.CPP itself, which join no nodes of ROS."""
_EXPLICIT = frozenset({"Action", "Condition", "Control", "Decorator"})
_SUBTREE = frozenset({"SubTree", "SubTreePlus"})
_NO_PORTS = frozenset({"ID", "name"})


@dataclass(frozen=True, slots=True)
class TreeNode:
    """A node of a tree: what it is registered as, and the attributes that are its ports."""

    id: str
    ports: tuple[tuple[str, str], ...]
    line: int


def read_tree_nodes(text: str, path: str, tree_id: str = "") -> Iterator[TreeNode]:
    """Yield the nodes of a file's main tree, or of the tree `tree_id`, with its subtrees.

    Raise InputError for what is no XML of trees, or has too many nodes.
    """
    root = parse_xml_bytes(text.encode("utf-8", "replace"), path)
    trees = {str(tree.get("ID", "")): tree for tree in root.iterchildren("BehaviorTree")}
    first = str(root.get("main_tree_to_execute") or next(iter(trees), ""))
    waiting, seen, count = [tree_id if tree_id in trees else first], set[str](), 0
    while waiting:
        tree = waiting.pop()
        if tree in trees and tree not in seen:
            seen.add(tree)
            for element in trees[tree].iterdescendants("*"):
                count += 1
                if count > MAX_NODES:
                    raise InputError(f"has more than {MAX_NODES} nodes", path=path)
                if element.tag in _SUBTREE:
                    waiting.append(str(element.get("ID", "")))
                yield _read_node(element)


def _read_node(element: Element) -> TreeNode:
    tag, given = str(element.tag), {str(k): str(v) for k, v in element.attrib.items()}
    ports = tuple((k, v) for k, v in given.items() if k not in _NO_PORTS and not k.startswith("_"))
    return TreeNode(given.get("ID", tag) if tag in _EXPLICIT else tag, ports, line_of(element))
