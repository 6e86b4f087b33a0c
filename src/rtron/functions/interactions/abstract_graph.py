"""The abstract interaction graph: what functions of a robot do to each other (paper section 3.2).

Two functions interact directly if one publishes a message type that the other subscribes, and
indirectly if one acts on the environment that the other senses. Types are read from source where
that is given; what is typical of a function fills in the rest, and each type says which it was.
The functions of the Others domain are no part of the graph, as the paper has it.
"""

from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field

from rtron.functions.domains import DOMAIN_BY_TYPE
from rtron.functions.interactions.typical_messages import (
    SENSORS,
    TypicalTraffic,
    environment_effects,
    function_of,
    is_generic,
    is_informative,
    is_ros2,
    is_typical_flow,
    ros2_types,
    subfunction_of,
    typical_traffic,
)
from rtron.vocabulary import (
    Domain,
    FunctionType,
    RecognitionSubfunction,
    StringEnum,
    UnresolvedItem,
    normalise_type,
)

FUNCTIONS_SCHEMA = "rtron.functions/1"
_NO_TRAFFIC = TypicalTraffic()
_ORDER = [*FunctionType, *RecognitionSubfunction]
_PREPROCESSING = FunctionType.PREPROCESSING.value


class Basis(StringEnum):
    """How it is known that two functions exchange a type.

    `source`: packages on both sides do, in their source. `manifest`: it is typical of both, and
    packages on both sides depend on the type's package or have it in their source. `typical`: it
    is typical of both, and nothing was read.
    """

    SOURCE = "source"
    MANIFEST = "manifest"
    TYPICAL = "typical"


@dataclass(frozen=True, slots=True, kw_only=True)
class PackageMessages:
    """A package, its functions, and which messages it is known to use.

    `publishes` and `subscribes` are message types found in its source; `depends` are the packages
    that its manifest names.
    """

    name: str
    description: str = ""
    functions: tuple[FunctionType, ...] = ()
    publishes: frozenset[str] = frozenset()
    subscribes: frozenset[str] = frozenset()
    depends: frozenset[str] = frozenset()


@dataclass(frozen=True, slots=True, kw_only=True)
class FunctionNode:
    """A function of the graph, and how many packages have it; a subfunction stands for itself."""

    name: str
    function: FunctionType
    domain: Domain
    packages: int


@dataclass(frozen=True, slots=True, kw_only=True)
class ExchangedMessage:
    """A message type, and how many packages are known to publish and to subscribe it.

    `publishers` and `subscribers` have it in their source. `from_depends` and `to_depends` are the
    packages on either side whose manifests depend on the type's package: they may use it.
    """

    type: str
    publishers: int = 0
    subscribers: int = 0
    from_depends: int = 0
    to_depends: int = 0

    @property
    def sides(self) -> tuple[int, int]:
        """How many packages use it on either side, by their source, else by their manifests."""
        return self.publishers or self.from_depends, self.subscribers or self.to_depends

    @property
    def basis(self) -> Basis:
        """How it is known."""
        if self.publishers and self.subscribers:
            return Basis.SOURCE
        return Basis.MANIFEST if all(self.sides) else Basis.TYPICAL


@dataclass(frozen=True, slots=True, kw_only=True)
class DirectInteraction:
    """One function publishes what another subscribes; the best known types come first."""

    source: str
    target: str
    messages: tuple[ExchangedMessage, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class IndirectInteraction:
    """One function changes the environment that another senses; `through` says what changes."""

    source: str
    target: str
    through: str


@dataclass(frozen=True, slots=True, kw_only=True)
class AbstractGraph:
    """Functions and their interactions; `packages` were looked at, `outside` have no place in it.

    `outside` counts the packages without a function and those of the Others domain, `repeated`
    those that were left out since another of their name counts already. `unresolved` is what could
    not be found out of the programs.
    """

    functions: tuple[FunctionNode, ...] = ()
    direct: tuple[DirectInteraction, ...] = ()
    indirect: tuple[IndirectInteraction, ...] = ()
    packages: int = 0
    outside: int = 0
    repeated: int = 0
    unresolved: tuple[UnresolvedItem, ...] = ()

    def count_by_basis(self) -> Mapping[Basis, int]:
        """Return how many types of all edges are known in which way."""
        counts = Counter(message.basis for edge in self.direct for message in edge.messages)
        return {basis: counts[basis] for basis in Basis}


@dataclass(slots=True)
class _FunctionUse:
    """What the packages of one function use, as numbers of packages."""

    packages: int = 0
    publishes: Counter[str] = field(default_factory=Counter)
    subscribes: Counter[str] = field(default_factory=Counter)
    depends: Counter[str] = field(default_factory=Counter)


def abstract_graph(packages: Iterable[PackageMessages]) -> AbstractGraph:
    """Return the interaction graph of the functions that packages have."""
    all_packages = tuple(packages)
    uses = _uses_by_function(all_packages)
    return AbstractGraph(
        functions=tuple(_node(name, uses[name].packages) for name in uses),
        direct=tuple(_direct(uses, frozenset() if _has_ros2(all_packages) else ros2_types())),
        indirect=tuple(_indirect(uses)),
        packages=len(all_packages),
        outside=sum(not any(map(_is_in_graph, package.functions)) for package in all_packages),
    )


def _has_ros2(packages: Iterable[PackageMessages]) -> bool:
    """Tell whether a package is one of ROS 2's own, or depends on one."""
    return any(is_ros2(name) for each in packages for name in (each.name, *each.depends))


def _is_in_graph(function: FunctionType) -> bool:
    return DOMAIN_BY_TYPE[function] is not Domain.OTHERS


def _node(name: str, packages: int) -> FunctionNode:
    function = function_of(name)
    return FunctionNode(
        name=name, function=function, domain=DOMAIN_BY_TYPE[function], packages=packages
    )


def _uses_by_function(packages: Iterable[PackageMessages]) -> Mapping[str, _FunctionUse]:
    """Return what each function uses, in the order of the vocabulary."""
    uses: dict[str, _FunctionUse] = {}
    for package in packages:
        names = _function_names(package)
        for name in names:
            _count_package(uses.setdefault(name, _FunctionUse()), name, names, package)
    return {name.value: uses[name.value] for name in _ORDER if name.value in uses}


def _function_names(package: PackageMessages) -> tuple[str, ...]:
    """Return the package's functions that have a place, Recognition as its subfunction."""
    subscribed = frozenset(map(normalise_type, package.subscribes))
    subfunction = subfunction_of(package.name, package.description, subscribed)
    names = (
        subfunction.value
        if subfunction and function is FunctionType.RECOGNITION
        else function.value
        for function in package.functions
        if _is_in_graph(function)
    )
    return tuple(dict.fromkeys(names))


def _count_package(
    use: _FunctionUse, name: str, names: Sequence[str], package: PackageMessages
) -> None:
    use.packages += 1
    table = {each: typical_traffic().get(each, _NO_TRAFFIC) for each in names}
    published = {each: traffic.publishes for each, traffic in table.items()}
    subscribed = {each: traffic.subscribes for each, traffic in table.items()}
    use.publishes.update(_types_of_function(name, package.publishes, published))
    use.subscribes.update(_types_of_function(name, package.subscribes, subscribed))
    use.depends.update(package.depends)


def _types_of_function(
    name: str, types: Iterable[str], types_by_function: Mapping[str, frozenset[str]]
) -> Iterator[str]:
    """Yield the types of a package that are one function's: where several, the typical one's.

    What is typical of none of them is the first one's.
    """
    first = next(iter(types_by_function))
    for type in sorted(set(map(normalise_type, types))):
        owners = [
            each for each, types_of_each in types_by_function.items() if type in types_of_each
        ] or [first]
        if name in owners and is_informative(type):
            yield type


def _direct(
    uses: Mapping[str, _FunctionUse], absent: frozenset[str]
) -> Iterator[DirectInteraction]:
    """Yield who publishes what whom subscribes; `absent` types count only where they are read."""
    for source in uses:
        for target in uses:
            messages = tuple(_exchanged_messages(source, target, uses, absent))
            if messages:
                ranked = sorted(messages, key=_rank)
                yield DirectInteraction(source=source, target=target, messages=tuple(ranked))


def _exchanged_messages(
    source: str, target: str, uses: Mapping[str, _FunctionUse], absent: frozenset[str]
) -> Iterator[ExchangedMessage]:
    if source == target:
        return
    published, subscribed = uses[source].publishes, uses[target].subscribes
    typical = typical_types(source, target) - absent
    for type in sorted(typical | _common_types(published, subscribed)):
        if _is_preprocessed(type, source, target, uses):
            continue
        if type in typical or not is_generic(type):
            yield _message_counts(type, uses[source], uses[target])


def typical_types(source: str, target: str) -> frozenset[str]:
    """Return the types that typically flow from one function to another."""
    if not is_typical_flow(source, target):
        return frozenset()
    table = typical_traffic()
    return table.get(source, _NO_TRAFFIC).publishes & table.get(target, _NO_TRAFFIC).subscribes


def _common_types(published: Mapping[str, int], subscribed: Mapping[str, int]) -> frozenset[str]:
    return frozenset(published) & frozenset(subscribed)


def _is_preprocessed(type: str, source: str, target: str, uses: Mapping[str, _FunctionUse]) -> bool:
    """Tell whether raw data reach the target through Preprocessing (paper 3.1)."""
    if source != SENSORS or target == _PREPROCESSING or _PREPROCESSING not in uses:
        return False
    return type in typical_traffic()[_PREPROCESSING].publishes


def _message_counts(type: str, source: _FunctionUse, target: _FunctionUse) -> ExchangedMessage:
    package = type.partition("/")[0]
    return ExchangedMessage(
        type=type,
        publishers=source.publishes[type],
        subscribers=target.subscribes[type],
        from_depends=source.depends[package],
        to_depends=target.depends[package],
    )


def _rank(message: ExchangedMessage) -> tuple[int, int, str]:
    return list(Basis).index(message.basis), -min(message.sides), message.type


def _indirect(uses: Mapping[str, _FunctionUse]) -> Iterator[IndirectInteraction]:
    for effect in environment_effects():
        for source in effect.sources:
            for target in effect.targets:
                if source in uses and target in uses:
                    yield IndirectInteraction(source=source, target=target, through=effect.through)
