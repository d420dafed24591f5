"""Pass orders: permutations of 0..count-1, where neighbours in the field have neighbouring numbers. Pure.

The methods' names are those of Inoue et al., who give no more than the names; what an order means is our reading:
round trip is the boustrophedon, transfer leaves passes out and fills them back, intermediate division works the field
in lands.
"""

from itertools import chain, pairwise

__all__ = ["lands", "neighbours", "racetrack", "skipping"]


def neighbours(count: int) -> tuple[int, ...]:
    """Each pass beside the one before: 1 2 3 4 5 6."""
    return tuple(range(count))


def skipping(count: int, skip: int) -> tuple[int, ...]:
    """Leaves ``skip`` passes out on the way across and fills them back: with 1, 1 3 5 6 4 2; 0 is the neighbours.

    Each sweep takes every (skip + 1)-th pass; the sweeps cross the field alternately there and back.
    """
    stride = skip + 1
    sweeps = (range(first, count, stride) for first in range(min(stride, count)))
    there_and_back = (reversed(sweep) if place % 2 else sweep for place, sweep in enumerate(sweeps))
    return tuple(chain.from_iterable(there_and_back))


def lands(count: int, land: int) -> tuple[int, ...]:
    """Opens each land in its middle, then right and left in turn: with land 6, 3 4 2 5 1 6.

    The field is cut into lands that differ by at most one pass and come as near to ``land`` passes as they can.
    """
    number = max(1, round(count / land)) if count else 0
    edges = [count * part // number for part in range(number + 1)] if number else [0]
    return tuple(chain.from_iterable(_from_the_middle(low, high) for low, high in pairwise(edges)))


def _from_the_middle(low: int, high: int) -> list[int]:
    middle = low + (high - low - 1) // 2
    right = range(middle + 1, high)
    left = range(middle - 1, low - 1, -1)
    order = [middle]
    for step in range(max(len(right), len(left))):
        order.extend(side[step] for side in (right, left) if step < len(side))
    return order


def racetrack(count: int, half: int) -> tuple[int, ...]:
    """Rounds without tight turns in blocks of two halves: with half 4, 5 1 6 2 7 3 8 4.

    In a whole block neighbours in the order lie ``half`` or ``half`` + 1 passes apart. A rest narrower than a block is
    begun at its near side: 9 11 10 12.
    """
    order: list[int] = []
    for low in range(0, count, 2 * half):
        size = min(2 * half, count - low)
        near = range(low, low + (size + 1) // 2)
        far = range(low + (size + 1) // 2, low + size)
        first, second = (far, near) if size == 2 * half else (near, far)
        order.extend(pair for step in range(len(near)) for pair in _both(first, second, step))
    return tuple(order)


def _both(first: range, second: range, step: int) -> list[int]:
    return [side[step] for side in (first, second) if step < len(side)]
