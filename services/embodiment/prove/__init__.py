"""Proofs that a container cannot be moved: found here, verified by `proof_check`."""

from services.embodiment.prove.grasps import claimed
from services.embodiment.prove.heights import out_of_reach
from services.embodiment.prove.in_hand import in_hand
from services.embodiment.prove.limbs.beside import never
from services.embodiment.prove.proved import Proved
from services.embodiment.prove.prover import Prover

__all__ = ["Proved", "Prover", "claimed", "in_hand", "never", "out_of_reach"]
