from rtron.demos.cases.agent import AGENT
from rtron.demos.cases.case_study import Case, Decisions, RunConditions
from rtron.demos.cases.paper_cases import GR, MSR, RSR

CASES = {case.name: case for case in (GR, RSR, MSR, AGENT)}

__all__ = ["AGENT", "CASES", "GR", "MSR", "RSR", "Case", "Decisions", "RunConditions"]
