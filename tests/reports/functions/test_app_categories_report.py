"""What kind of apps there are, told to people and programs."""

import pytest

from rtron.functions.app_categories import AppProfile, categories_of, nearest_category
from rtron.reports.functions.app_categories import apps_text, apps_to_json
from rtron.vocabulary import FunctionType as F

DRIVES_ITSELF = {F.PREPROCESSING, F.RECOGNITION, F.PATH_TRACKING, F.GOAL_PLANNER}


@pytest.mark.parametrize(
    ("present", "expected"),
    [
        ({F.TELEOPERATION}, "nearest: Remote Control, without Mobile or Manipulator"),
        (
            DRIVES_ITSELF,
            (
                "nearest larger: Object Search / Autonomous Driving, without Localization, "
                "Path Planning, Mobile"
            ),
        ),
    ],
)
def test_the_nearest_is_told(present, expected, printed):
    near = nearest_category(present)
    row = AppProfile(app="app", functions={}, categories=categories_of(present), nearest=near)
    assert expected in " ".join(printed(apps_text([row], ())).split())
    (app,) = apps_to_json([row], ())["apps"]
    assert app["nearest"] == {
        "categories": list(near.categories),
        "missing": list(map(str, near.missing.missing)),
        "one_of": list(map(str, near.missing.one_of)),
    }


def test_where_nothing_is_near_nothing_is_told(printed):
    row = AppProfile(app="app", functions={}, categories=())
    assert "nearest" not in printed(apps_text([row], ()))
    assert apps_to_json([row], ())["apps"][0]["nearest"] is None
