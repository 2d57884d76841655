"""Re-verification of proofs of infeasibility: own kinematics, intervals, no planner, no prover."""

from services.embodiment.proof_check.check import Checked, check

__all__ = ["Checked", "check"]
