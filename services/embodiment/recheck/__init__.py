"""Re-verification of stored verdicts, without the code that planned or proved them."""

from services.embodiment.recheck.check import Rechecked, is_artefact, recheck_artefact, recheck_verdict
from services.embodiment.recheck.saved import Saved

__all__ = ["Rechecked", "Saved", "is_artefact", "recheck_artefact", "recheck_verdict"]
