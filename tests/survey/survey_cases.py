"""A survey of three apps, for what is made of it."""

from rtron.functions.app_categories import AppProfile
from rtron.functions.reading.skipped_entries import SkippedEntry
from rtron.survey.app_survey import AppResult, AppSurvey, FunctionLink, ListedFinding, ListedRisk
from rtron.survey.survey_run import Survey
from rtron.vocabulary import CoordinationCount, Domain, FunctionType, RiskKind, Severity

HOSTILE = "evil/<script>alert(1)</script>/x.launch"
F = FunctionType
NAVIGATION = (F.PREPROCESSING, F.LOCALIZATION, F.PATH_PLANNING, F.PATH_TRACKING, F.MOBILE)


def app_survey(name, **changes):
    values = {
        "nodes": 8,
        "topics": 20,
        "risks": {RiskKind.GR_ST: 2, RiskKind.MSR: 1},
        "coordination_nodes": CoordinationCount(
            grcn={Domain.CONTROL: 1, Domain.PERCEPTION: 1}, fps_monitor=1, rsrcn=0, msrcn=1
        ),
        "profile": AppProfile(
            app=name,
            functions={function: (f"/{function.name.lower()}",) for function in NAVIGATION},
            categories=("Navigation",),
        ),
        "unresolved": 3,
        "finding_counts": {"several_publishers": 1},
        "listed_risks": (
            ListedRisk(
                kind=RiskKind.GR_ST,
                severity=Severity.HIGH,
                topics=("/cmd_vel",),
                nodes=("/teleop", "/tracker"),
                place="me/app/launch/x.launch:7",
            ),
        ),
        "listed_findings": (
            ListedFinding(
                rule="several_publishers",
                severity=Severity.HIGH,
                summary="/teleop and /tracker both drive the robot on /cmd_vel",
                place="me/app/launch/x.launch:7",
            ),
        ),
        "links": (
            FunctionLink(
                source=F.PATH_PLANNING,
                target=F.PATH_TRACKING,
                type="nav_msgs/Path",
                topics=("/plan",),
            ),
            FunctionLink(
                source=F.PATH_TRACKING,
                target=F.MOBILE,
                type="geometry_msgs/Twist",
                topics=("/cmd_vel",),
            ),
        ),
    }
    return AppSurvey(**{**values, **changes})


def app_result(name, ros=1, **changes):
    survey = app_survey(name, **changes)
    return AppResult(
        app=name, repository=name.partition("/")[0], ros=ros, seconds=1.5, survey=survey
    )


SURVEY = Survey(
    results=[
        app_result("one/launch/nav.launch"),
        app_result(
            HOSTILE,
            ros=2,
            nodes=25,
            risks={RiskKind.GR_MT: 4},
            finding_counts={},
            listed_findings=(),
            links=(),
            profile=AppProfile(app=HOSTILE, functions={F.TELEOPERATION: ("/t",)}, categories=()),
        ),
        AppResult(
            app="late/launch/late.launch",
            repository="late",
            ros=2,
            seconds=60.0,
            error="not done within 60 s",
        ),
    ],
    left_out=[SkippedEntry(location="one/launch/a.launch", reason="needs the arguments robot")],
    seconds=63.0,
)
