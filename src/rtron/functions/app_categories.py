"""What kind of app an app is: the paper's table of apps, by the functions of its nodes.

A category fits an app whose nodes have all its functions. Of those that fit, the most specific
count: no other that fits has all of its functions and more. Categories that share one set of
functions (Face/Person and Object/Scene Detection; Object Search and Autonomous Driving) cannot be
told apart by it, so both are named.
"""

from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cache

from rtron.functions.interactions.typical_messages import typical_traffic
from rtron.functions.node_functions import NodeFunctions, functions_of_nodes
from rtron.functions.repository import load_package_yaml
from rtron.functions.traffic_rules import (
    NodeTraffic,
    TrafficRule,
    node_traffic,
    parse_traffic_rule,
    publishes_typical,
)
from rtron.vocabulary import FunctionType, InteractionGraph

PAPER_APP_COUNT = 110


@dataclass(frozen=True, slots=True, kw_only=True)
class Category:
    """A row of the paper's table; `one_of` are functions of which one at least is there."""

    name: str
    functions: frozenset[FunctionType]
    one_of: frozenset[FunctionType] = frozenset()
    apps: int = 0
    robots: tuple[str, ...] = ()
    example: str = ""

    def required_functions(self, present: Collection[FunctionType]) -> frozenset[FunctionType]:
        """Return which of the functions present the category takes; none if it does not fit."""
        chosen = self.one_of & frozenset(present)
        fits = self.functions <= frozenset(present) and (chosen or not self.one_of)
        return self.functions | chosen if fits else frozenset()

    def count_present(self, present: Collection[FunctionType]) -> int:
        """Return how many functions of the category are there; of `one_of` one counts."""
        there = frozenset(present)
        return len(self.functions & there) + (not self.one_of.isdisjoint(there))

    def missing_functions(self, present: Collection[FunctionType]) -> "MissingFunctions":
        """Return what the category takes and is not there."""
        has_none = self.one_of.isdisjoint(present)
        return MissingFunctions(
            missing=tuple(f for f in FunctionType if f in self.functions - frozenset(present)),
            one_of=tuple(f for f in FunctionType if f in self.one_of) if has_none else (),
        )

    @property
    def key(self) -> tuple[frozenset[FunctionType], frozenset[FunctionType]]:
        """What it is told by; categories that share it cannot be told apart."""
        return self.functions, self.one_of


@dataclass(frozen=True, slots=True, kw_only=True)
class AppProfile:
    """An app, the nodes of each function in it, and its most specific categories.

    `nearest` is a category that the app does not belong to, but has more functions of than of any
    of its own categories.
    """

    app: str
    functions: Mapping[FunctionType, tuple[str, ...]]
    categories: tuple[str, ...]
    nearest: "NearestCategory | None" = None


@dataclass(frozen=True, slots=True, kw_only=True)
class NearestCategory:
    """The categories, of one set of functions, that an app comes nearest to, and what it lacks."""

    categories: tuple[str, ...]
    missing: "MissingFunctions"


@dataclass(frozen=True, slots=True, kw_only=True)
class MissingFunctions:
    """The functions that an app lacks for a category: all of `missing`, and one of `one_of`."""

    missing: tuple[FunctionType, ...] = ()
    one_of: tuple[FunctionType, ...] = ()

    def __len__(self) -> int:
        return len(self.missing) + bool(self.one_of)


@dataclass(frozen=True, slots=True, kw_only=True)
class CategoryCount:
    """How many apps are of categories that share a set, here and in the paper's table."""

    categories: tuple[str, ...]
    functions: frozenset[FunctionType]
    one_of: frozenset[FunctionType]
    apps: int
    paper: int


@cache
def categories() -> tuple[Category, ...]:
    """Return the 14 categories of the paper, in its order."""
    return tuple(
        Category(
            name=each["name"],
            functions=frozenset(map(FunctionType, each["functions"])),
            one_of=frozenset(map(FunctionType, each.get("one_of", ()))),
            apps=each["apps"],
            robots=tuple(each["robots"]),
            example=each["example"],
        )
        for each in load_package_yaml("rtron.functions", "apps.yaml")["categories"]
    )


def categories_of(present: Collection[FunctionType]) -> tuple[str, ...]:
    """Return the most specific categories of an app, those with the most functions first."""
    fitting = {c.name: needs for c in categories() if (needs := c.required_functions(present))}
    most = [
        n
        for n, needs in fitting.items()
        if not any(needs < other_needs for other_needs in fitting.values())
    ]
    return tuple(sorted(most, key=lambda name: -len(fitting[name])))


def app_profile(graph: InteractionGraph, name: str = "") -> AppProfile:
    """Return an app's functions and categories; `name` stands for that of its graph."""
    functions = functions_of_app(graph)
    return AppProfile(
        app=name or graph.app or "app",
        functions=functions,
        categories=categories_of(functions.keys()),
        nearest=nearest_category(functions.keys()),
    )


def nearest_category(present: Collection[FunctionType]) -> NearestCategory | None:
    """Return the category with the most functions present, of equals the one that lacks fewest.

    None if one that fits has as many.
    """
    best = max(
        categories(), key=lambda c: (c.count_present(present), -len(c.missing_functions(present)))
    )
    lack = best.missing_functions(present)
    if not (best.count_present(present) and lack):
        return None
    return NearestCategory(
        categories=tuple(c.name for c in categories() if c.key == best.key), missing=lack
    )


def functions_of_app(graph: InteractionGraph) -> Mapping[FunctionType, tuple[str, ...]]:
    """Return the nodes of each function that an app has, in the order of the paper's table.

    A map that is only handed out was not made by the app: it is no Mapping. Where a node's package
    has several functions, those count of which the node publishes what is typical. A simulator
    stands in for the drivers whose commands it takes, and a driver whose data others take hands on
    what Preprocessing would (`stand_ins` in `nodes.yaml`).
    """
    nodes_by_function: dict[FunctionType, list[str]] = {function: [] for function in FunctionType}
    traffic = node_traffic(graph)
    for node, node_functions in functions_of_nodes(graph).items():
        for function in _played_functions(node_functions, traffic[node]):
            nodes_by_function[function].append(node)
    return {function: tuple(nodes) for function, nodes in nodes_by_function.items() if nodes}


def count_categories(rows: Iterable[AppProfile]) -> tuple[CategoryCount, ...]:
    """Return how many apps are of each set of functions; an app counts where it fits best."""
    best = [_best_category(row) for row in rows]
    groups: dict[object, list[Category]] = {}
    for category in categories():
        groups.setdefault(category.key, []).append(category)
    return tuple(_category_count(group, best) for group in groups.values())


def _best_category(row: AppProfile) -> str:
    return row.categories[0] if row.categories else ""


def _category_count(group: Sequence[Category], best: Sequence[str]) -> CategoryCount:
    names = tuple(category.name for category in group)
    return CategoryCount(
        categories=names,
        functions=group[0].functions,
        one_of=group[0].one_of,
        apps=sum(name in names for name in best),
        paper=sum(category.apps for category in group),
    )


def _played_functions(
    node_functions: NodeFunctions, traffic: NodeTraffic
) -> tuple[FunctionType, ...]:
    """Return the functions that a node has in its app, each once."""
    certain = [
        f
        for f in node_functions.functions
        if node_functions.is_certain or publishes_typical(f, traffic)
    ]
    own_functions = [f for f in certain if f is not FunctionType.MAPPING or _makes_map(traffic)]
    stands_in = (
        rule.functions[0]
        for by, rule in _simulator_rules()
        if not by.isdisjoint(node_functions.functions) and rule.fits(traffic)
    )
    return tuple(dict.fromkeys((*own_functions, *stands_in)))


def _makes_map(traffic: NodeTraffic) -> bool:
    """Tell whether a node makes its map: one that only hands out a known map senses nothing."""
    usual = typical_traffic()[FunctionType.MAPPING.value]
    return not usual.subscribes.isdisjoint(traffic.subscribes)


@cache
def _simulator_rules() -> tuple[tuple[frozenset[FunctionType], TrafficRule], ...]:
    entries = load_package_yaml("rtron.functions", "nodes.yaml")["stand_ins"]
    return tuple(
        (frozenset(map(FunctionType, e["by"])), parse_traffic_rule([e["function"]], e))
        for e in entries
    )
