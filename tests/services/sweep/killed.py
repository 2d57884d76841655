"""A sweep that is to be killed: `python -m tests.services.sweep.killed STORE`.

It says which case is kept, and goes on when a line comes in.
"""

import multiprocessing as mp
import sys

from services.store.files import SavedVerdicts
from services.sweep.executors.engines import processes
from services.sweep.plan import Axes, grid
from services.sweep.run import run
from services.sweep.summary import Kept

if __name__ == "__main__":
    with SavedVerdicts(sys.argv[1]) as saved:
        kept = Kept(saved)
        for found in run(grid(["b"], ["pr2"], Axes(("close",))).cells, processes(2), saved.stored):
            kept.add(found)
            pids = " ".join(str(each.pid) for each in mp.active_children())
            sys.stdout.write(f"{found.cell.task} {pids}\n")
            sys.stdout.flush()
            sys.stdin.readline()
