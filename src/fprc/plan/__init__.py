"""The results, what each is made of, and which of them can be made from the existing logs."""

from fprc.plan.availability import refusal
from fprc.plan.paths import Paths
from fprc.plan.plan import Plan, read_plan
from fprc.plan.results import BY_NAME

__all__ = ["BY_NAME", "Paths", "Plan", "read_plan", "refusal"]
