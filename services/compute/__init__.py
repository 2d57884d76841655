"""What a query asks for and nobody has computed yet is computed before it runs (ARCHITECTURE, decision 2)."""

from services.compute.patterns import Pattern, not_judged, verdict_patterns
from services.compute.plan import Plan, Request, Unplanned, planned
from services.compute.run import Bounds, Computed, Keeper, Loaded, compute

__all__ = [
    "Bounds",
    "Computed",
    "Keeper",
    "Loaded",
    "Pattern",
    "Plan",
    "Request",
    "Unplanned",
    "compute",
    "not_judged",
    "planned",
    "verdict_patterns",
]
