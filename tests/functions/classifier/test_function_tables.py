import pytest

from rtron.functions.classifier import tables
from rtron.functions.classifier.result import (
    Classification,
    DecisionSource,
    InformationSource,
    RuleEvidence,
)
from rtron.functions.classifier.tables import (
    ClassificationCounts,
    PaperTables,
    build_tables,
    sum_domains,
    sum_function_nodes,
)
from rtron.functions.domains import DOMAIN_BY_TYPE
from rtron.vocabulary import Domain, FunctionType

DOMAIN_SHARES = {
    Domain.PERCEPTION: 17.6,
    Domain.PLANNING: 10.0,
    Domain.CONTROL: 10.0,
    Domain.DRIVERS: 18.4,
    Domain.OTHERS: 44.0,
}
"""In per cent, as the paper prints them (section 3.1)."""
SLAM, MAP, PLAN = FunctionType.LOCALIZATION, FunctionType.MAPPING, FunctionType.PATH_PLANNING


def evidence_of(piece, type, package=""):
    return RuleEvidence(source=piece, type=type, text="x", rule="r", package=package)


def classification(decided_by, *functions, evidence=()):
    primary = functions[0] if functions else None
    return Classification(
        repo="r", functions=functions, primary=primary, decided_by=decided_by, evidence=evidence
    )


def test_the_papers_tables_tell_of_the_same_repositories():
    assert (
        set(tables.REPOSITORIES_BY_TYPE)
        == set(tables.CLASSIFICATION_COUNTS)
        == set(tables.AUTOMATION_BY_TYPE)
        == set(FunctionType)
    )
    assert {
        type: tally.total for type, tally in tables.CLASSIFICATION_COUNTS.items()
    } == tables.REPOSITORIES_BY_TYPE
    assert sum(tables.REPOSITORIES_BY_TYPE.values()) == 1135


@pytest.mark.parametrize("domain", Domain)
def test_the_papers_shares_are_those_of_its_numbers(domain):
    share = 100 * sum_domains(tables.CLASSIFICATION_COUNTS, (domain,)).total / 1135
    assert round(share, 1) == DOMAIN_SHARES[domain]


@pytest.mark.parametrize("type", FunctionType)
def test_the_papers_rates_are_those_of_its_numbers(type):
    assert (
        round(100 * tables.CLASSIFICATION_COUNTS[type].automation, 2)
        == tables.AUTOMATION_BY_TYPE[type]
    )


def test_the_papers_function_nodes_are_the_sum_of_the_first_14():
    found = sum_function_nodes(tables.CLASSIFICATION_COUNTS)
    assert found == tables.FUNCTION_NODE_COUNTS
    assert round(100 * found.automation, 2) == tables.FUNCTION_NODE_AUTOMATION
    assert (
        sum(DOMAIN_BY_TYPE[type] is not Domain.OTHERS for type in tables.CLASSIFICATION_COUNTS)
        == 14
    )


def test_of_none_there_is_no_rate():
    assert ClassificationCounts().automation is None
    assert ClassificationCounts(none=1).automation == 0
    assert ClassificationCounts(name=1, none=3).automation == 0.25
    assert ClassificationCounts(name=1, manifest=2, code=16, readme=4, none=8).total == 31
    assert ClassificationCounts(name=1, manifest=2, code=16, readme=4, none=8).decided == 23


def test_a_repository_counts_once_for_each_function():
    tables = build_tables(
        [
            classification(DecisionSource.NAME, SLAM, MAP),
            classification(DecisionSource.README, MAP),
            classification(DecisionSource.NONE, FunctionType.EXTENSION),
        ]
    )
    others = {type: ClassificationCounts() for type in FunctionType}
    assert tables == PaperTables(
        repositories=3,
        decided=2,
        expected_right=None,
        types={
            **others,
            SLAM: ClassificationCounts(name=1),
            MAP: ClassificationCounts(name=1, readme=1),
            FunctionType.EXTENSION: ClassificationCounts(none=1),
        },
    )


def test_a_second_function_is_decided_by_the_first_piece_that_told_it():
    evidence = (
        evidence_of(InformationSource.NAME, SLAM),
        evidence_of(InformationSource.README, MAP),
        evidence_of(InformationSource.MANIFEST, MAP, "a"),
        evidence_of(InformationSource.NAME, PLAN),
    )
    evidence += (evidence_of(InformationSource.NAME, MAP, "a"),)
    found = build_tables([classification(DecisionSource.MANIFEST, SLAM, MAP, evidence=evidence)])
    assert found.types[SLAM] == ClassificationCounts(manifest=1)
    assert found.types[MAP] == ClassificationCounts(manifest=1)
    assert found.types[PLAN] == ClassificationCounts()
    (readme,) = {each for each in found.types.values() if each.readme} or {None}
    assert readme is None


def test_the_name_of_a_package_stands_in_its_manifest():
    evidence = (
        evidence_of(InformationSource.NAME, SLAM),
        evidence_of(InformationSource.NAME, MAP, "a"),
    )
    found = build_tables([classification(DecisionSource.NAME, SLAM, MAP, evidence=evidence)])
    assert (found.types[SLAM], found.types[MAP]) == (
        ClassificationCounts(name=1),
        ClassificationCounts(manifest=1),
    )


def test_nothing_at_all():
    tables = build_tables([])
    assert (tables.repositories, tables.decided) == (0, 0)
    assert sum_domains(tables.types, Domain) == ClassificationCounts()
