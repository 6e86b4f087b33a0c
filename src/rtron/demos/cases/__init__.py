from rtron.demos.cases.agent import AGENT
from rtron.demos.cases.case_study import Case, Decisions, RunConditions
from rtron.demos.cases.gr import GR
from rtron.demos.cases.msr import MSR
from rtron.demos.cases.rsr import RSR

CASES = {case.name: case for case in (GR, RSR, MSR, AGENT)}

__all__ = ["AGENT", "CASES", "GR", "MSR", "RSR", "Case", "Decisions", "RunConditions"]
