"""Compiled inner loop of the lattice: A* over cells of base poses, as far as it is known which are free."""

import math

import numpy as np

from services.kernel import kernel, subkernel

UNKNOWN, FREE, TAKEN = 0, 1, 2
"""Of a cell: not looked at yet, free, or not."""

FOUND, NONE, FAR, ASKED = 0, 1, 2, 3
"""How a search comes back: with a way, with none, with too long a search, or for cells that it needs."""

STEPS = ((1, 0), (1, 1), (0, 1), (-1, 1), (-1, 0), (-1, -1), (0, -1), (1, -1))
"""Moves of one cell; after them come two turns, by one heading each."""

MOVES = len(STEPS) + 2
AHEAD = 32  # nodes that wait whose neighbours are asked for together


@subkernel
def beside(cell, move, shape, box):
    """The cell to which a move leads from a cell, both as numbers, or −1 outside the box.

    `shape` is (I, J, K) of all cells, `box` the first and the last i, and the same of j, of those searched.
    """
    turns = shape[2]
    i, j, k = cell // (shape[1] * turns), cell // turns % shape[1], cell % turns
    if move >= 8:
        return cell - k + (k + (1 if move == 8 else turns - 1)) % turns
    a, b = STEPS[move]
    i, j = i + a, j + b
    inside = box[0] <= i <= box[1] and box[2] <= j <= box[3]
    return (i * shape[1] + j) * turns + k if inside else -1


@subkernel
def _may(cell, move, shape, barred, omni):
    """Whether a base may try that move: sideways only if it is omnidirectional."""
    turns = shape[2]
    ahead = move >= 8 or 2 * move % (turns // 2) == cell % turns % (turns // 2)
    return (ahead or omni) and not (barred[cell] >> move) & 1


@subkernel
def _less(queue, nodes, a, b):
    return queue[a] < queue[b] or (queue[a] == queue[b] and nodes[a] < nodes[b])


@subkernel
def _swap(queue, nodes, a, b):
    queue[a], queue[b] = queue[b], queue[a]
    nodes[a], nodes[b] = nodes[b], nodes[a]


@subkernel
def push(queue, nodes, count, value, node):
    """The heap of `count` nodes has one more."""
    queue[count], nodes[count], at = value, node, count
    while at > 0 and _less(queue, nodes, at, (at - 1) // 2):
        _swap(queue, nodes, at, (at - 1) // 2)
        at = (at - 1) // 2


@subkernel
def _pop(queue, nodes, count):
    """The heap of `count` nodes has lost its first."""
    count, at = count - 1, 0
    queue[0], nodes[0] = queue[count], nodes[count]
    while True:
        low = at
        for child in (2 * at + 1, 2 * at + 2):
            if child < count and _less(queue, nodes, child, low):
                low = child
        if low == at:
            return
        _swap(queue, nodes, at, low)
        at = low


@subkernel
def _ask(cell, grid, omni, asked, count):
    """How many cells are asked for once those neighbours of a cell are that are not known."""
    shape, box, status, barred = grid
    for move in range(MOVES):
        if not _may(cell, move, shape, barred, omni):
            continue
        other = beside(cell, move, shape, box)
        if other >= 0 and status[other] == UNKNOWN:
            known = False
            for n in range(count):
                known = known or asked[n] == other
            if not known:
                asked[count] = other
                count += 1
    return count


@kernel
def search(grid, omni, lengths, target, most, last, run, marks, far, before, heap, asked):
    """(how it came back, the cell that it found or how many it asks for); to be called again when it asked.

    `grid` is what `beside` takes, then of each cell what is known of it and its barred moves, as bits.
    `lengths` are those of the moves [m], `target` is (i and j of the first cell, size of a cell [m], x and y
    of the goal [m], weight of what is left). From `most` cells one search goes on; it ends at those of
    `last`. `run` is its number: `marks` (2, cells) says which cells were reached in it, and which are done;
    `far` and `before` are the length of the way to each cell, and the cell before it. `heap` is (values,
    cells, (how many wait, how many are done)). In `asked` are cells of which it has to be known whether they
    are free.
    """
    shape, box, status, barred = grid
    queue, nodes, counts = heap
    while counts[0] > 0:
        cell = nodes[0]
        if marks[1, cell] == run:
            _pop(queue, nodes, counts[0])
            counts[0] -= 1
            continue
        ends = False
        for one in last:
            ends = ends or one == cell
        if not ends and _ask(cell, grid, omni, asked, 0) > 0:
            count = 0
            for n in range(min(AHEAD, counts[0])):
                count = _ask(nodes[n], grid, omni, asked, count)
            return ASKED, count
        _pop(queue, nodes, counts[0])
        counts[0] -= 1
        counts[1] += 1
        marks[1, cell] = run
        if ends:
            return FOUND, cell
        if counts[1] > most:
            return FAR, 0
        for move in range(MOVES):
            other = beside(cell, move, shape, box)
            if other < 0 or not _may(cell, move, shape, barred, omni) or status[other] != FREE:
                continue
            length = far[cell] + lengths[move]
            if marks[0, other] != run or length < far[other]:
                marks[0, other], far[other], before[other] = run, length, cell
                i, j = other // (shape[1] * shape[2]), other // shape[2] % shape[1]
                x, y = (i + target[0]) * target[2] - target[3], (j + target[1]) * target[2] - target[4]
                push(queue, nodes, counts[0], length + target[5] * math.hypot(x, y), other)
                counts[0] += 1
    return NONE, 0


def warm() -> None:
    """`search` has run once, with the types in which it is used."""
    grid = np.ones(3, np.int64), np.zeros(4, np.int64), np.zeros(1, np.int8), np.zeros(1, np.uint16)
    none, marks = np.zeros(0, np.int64), np.zeros((2, 1), np.int32)
    heap = np.zeros(0), none, np.zeros(2, np.int64)
    search(grid, True, np.zeros(MOVES), np.zeros(6), 1, none, 1, marks, np.zeros(1), none, heap, none)
