import pytest

from rtron.functions.classifier import paper_counts
from rtron.functions.classifier.result import Classification, DecidedBy, Evidence, Piece
from rtron.functions.classifier.tables import Tables, count, function_nodes, sum_of
from rtron.functions.classifier.tally import Tally
from rtron.functions.domains import DOMAIN_OF
from rtron.vocabulary import Domain, FunctionType

SLAM, MAP, PLAN = FunctionType.LOCALIZATION, FunctionType.MAPPING, FunctionType.PATH_PLANNING


def told(piece, type, package=""):
    return Evidence(piece=piece, type=type, text="x", rule="r", package=package)


def classified(decided_by, *functions, evidence=()):
    primary = functions[0] if functions else None
    return Classification(
        repo="r", functions=functions, primary=primary, decided_by=decided_by, evidence=evidence
    )


def test_the_papers_tables_tell_of_the_same_repositories():
    assert (
        set(paper_counts.REPOS)
        == set(paper_counts.DECIDED)
        == set(paper_counts.AUTOMATION)
        == set(FunctionType)
    )
    assert {type: tally.total for type, tally in paper_counts.DECIDED.items()} == paper_counts.REPOS
    assert sum(paper_counts.REPOS.values()) == 1135


@pytest.mark.parametrize("domain", Domain)
def test_the_papers_shares_are_those_of_its_numbers(domain):
    share = 100 * sum_of(paper_counts.DECIDED, (domain,)).total / 1135
    assert round(share, 1) == paper_counts.DOMAIN_SHARES[domain]


@pytest.mark.parametrize("type", FunctionType)
def test_the_papers_rates_are_those_of_its_numbers(type):
    assert round(100 * paper_counts.DECIDED[type].automation, 2) == paper_counts.AUTOMATION[type]


def test_the_papers_function_nodes_are_the_sum_of_the_first_14():
    found = function_nodes(paper_counts.DECIDED)
    assert found == paper_counts.FUNCTION_NODES
    assert round(100 * found.automation, 2) == paper_counts.FUNCTION_NODE_AUTOMATION
    assert sum(DOMAIN_OF[type] is not Domain.OTHERS for type in paper_counts.DECIDED) == 14


def test_of_none_there_is_no_rate():
    assert Tally().automation is None
    assert Tally(none=1).automation == 0
    assert Tally(name=1, none=3).automation == 0.25
    assert Tally(name=1, manifest=2, readme=4, none=8).total == 15
    assert Tally(name=1, manifest=2, readme=4, none=8).decided == 7


def test_a_repository_counts_once_for_each_function():
    tables = count(
        [
            classified(DecidedBy.NAME, SLAM, MAP),
            classified(DecidedBy.README, MAP),
            classified(DecidedBy.NONE),
        ]
    )
    others = {type: Tally() for type in FunctionType}
    assert tables == Tables(
        repositories=3,
        decided=2,
        types={
            **others,
            SLAM: Tally(name=1),
            MAP: Tally(name=1, readme=1),
            FunctionType.EXTENSION: Tally(none=1),
        },
    )


def test_a_second_function_is_decided_by_the_first_piece_that_told_it():
    evidence = (
        told(Piece.NAME, SLAM),
        told(Piece.README, MAP),
        told(Piece.MANIFEST, MAP, "a"),
        told(Piece.NAME, PLAN),
    )
    evidence += (told(Piece.NAME, MAP, "a"),)
    found = count([classified(DecidedBy.MANIFEST, SLAM, MAP, evidence=evidence)])
    assert found.types[SLAM] == Tally(manifest=1)
    assert found.types[MAP] == Tally(manifest=1)
    assert found.types[PLAN] == Tally()
    (readme,) = {each for each in found.types.values() if each.readme} or {None}
    assert readme is None


def test_the_name_of_a_package_stands_in_its_manifest():
    evidence = (told(Piece.NAME, SLAM), told(Piece.NAME, MAP, "a"))
    found = count([classified(DecidedBy.NAME, SLAM, MAP, evidence=evidence)])
    assert (found.types[SLAM], found.types[MAP]) == (Tally(name=1), Tally(manifest=1))


def test_nothing_at_all():
    tables = count([])
    assert (tables.repositories, tables.decided) == (0, 0)
    assert sum_of(tables.types, Domain) == Tally()
