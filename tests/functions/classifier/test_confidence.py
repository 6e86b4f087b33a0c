"""How sure functions are."""

import pytest

from rtron.functions.classifier.pipeline import classify
from rtron.functions.classifier.result import DecisionSource, InformationSource
from rtron.functions.classifier.scores import (
    FEATURES,
    FunctionScores,
    features,
    function_probabilities,
)
from rtron.functions.repository import SourcePackage, SourceRepository
from rtron.vocabulary import FunctionType

T = FunctionType


def scores(**weights_by_source):
    return {
        source: FunctionScores(weights_by_source.get(source.value, {}))
        for source in InformationSource
    }


def repository(name, *packages, readme=""):
    found = tuple(SourcePackage(name=n, description=d, depends=e) for n, d, e in packages)
    return SourceRepository(name=name, packages=found, readme=readme)


def test_the_features():
    found = scores(name={T.MAPPING: 4.5}, manifest={T.MAPPING: 20.0, T.SENSORS: 9.0})
    values = dict(zip(FEATURES, features(T.MAPPING, found), strict=True))
    assert values == {
        "constant": 1.0,
        "share": pytest.approx(1.5 / (1.5 + 1.0 + 0.1)),
        "support": pytest.approx(1.5),
        "vague": 0.0,
    }


def test_evidence_for_a_function_makes_it_surer_and_against_it_less_sure():
    def first(**found):
        return function_probabilities([T.MAPPING], scores(**found))[T.MAPPING]

    alone = first(name={T.MAPPING: 5})
    assert 0.5 < alone < 1
    assert first(name={T.MAPPING: 5}, code={T.MAPPING: 4}) > alone
    assert first(name={T.MAPPING: 5}, code={T.SENSORS: 4}) < alone


def test_a_further_function_has_its_own_probability():
    found = scores(name={T.MAPPING: 5, T.EXTENSION: 3})
    probabilities = function_probabilities([T.MAPPING, T.EXTENSION], found)
    assert list(probabilities) == [T.MAPPING, T.EXTENSION]
    assert probabilities[T.EXTENSION] < 0.5 < probabilities[T.MAPPING]


def test_all_pieces_count_though_the_name_decides():
    fits = classify(repository("grid_mapping", readme="It builds a map of the environment."))
    contradicts = classify(repository("grid_mapping", readme="A driver for a camera."))
    assert fits.decided_by is contradicts.decided_by is DecisionSource.NAME
    assert fits.primary is contradicts.primary is T.MAPPING
    assert fits.confidence > contradicts.confidence


def test_what_nothing_decided_is_less_sure_than_what_anything_did():
    undecided = classify(repository("zzz"))
    assert undecided.confidence < classify(repository("zzz_filters")).confidence


def test_code_decides_where_names_and_manifests_do_not():
    found = classify(repository("zzz", ("zzz", "", ("joy", "geometry_msgs"))))
    assert (found.primary, found.decided_by) == (T.TELEOPERATION, DecisionSource.CODE)
    (evidence,) = found.evidence
    assert (evidence.source, evidence.text) == (InformationSource.CODE, "depends joy")
    assert (evidence.rule, evidence.package) == ("code-joystick", "zzz")


def test_code_does_not_overrule_a_name():
    found = classify(repository("grid_mapping", ("grid_mapping", "", ("joy", "geometry_msgs"))))
    assert (found.primary, found.decided_by) == (T.MAPPING, DecisionSource.NAME)


def test_a_repository_of_code_alone_is_as_sure_as_its_packages_agree():
    drivers = [(f"z{n}", "", ("camera_info_manager",)) for n in range(3)]
    mixed = [*drivers[:2], ("z3", "", ("rqt_gui",))]
    alike, unlike = classify(repository("zzz", *drivers)), classify(repository("zzz", *mixed))
    assert alike.primary is unlike.primary is T.SENSORS
    assert alike.confidence > unlike.confidence
