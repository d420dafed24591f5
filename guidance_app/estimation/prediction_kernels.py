"""The arc of a tractor whose steering fades back to straight, compiled."""

import math

import numba

from guidance_app.model import FloatArray

__all__ = ["fading_arc"]


@numba.njit(cache=True)
def fading_arc(
    places: FloatArray, heading: float, speed: float, curvature: float, seconds: float, fading: float
) -> tuple[float, float]:
    """Fills ``places`` (K, 2), whose first row is where it begins, in equal steps of ``seconds`` in all.

    Gives how far the heading has turned in the end, and the part of the curvature that is left. Going back in time
    the curvature is kept.
    """
    steps = places.shape[0] - 1
    stretch = speed * seconds / steps
    turn, fade = 0.0, 1.0
    for k in range(1, steps + 1):
        after = seconds * k / steps
        fade = math.exp(-max(after, 0.0) / fading)
        driven = fading * (1.0 - fade) if after > 0 else after
        turned = speed * curvature * driven
        middle = heading + 0.5 * (turn + turned)
        places[k, 0] = places[k - 1, 0] + stretch * math.sin(middle)
        places[k, 1] = places[k - 1, 1] + stretch * math.cos(middle)
        turn = turned
    return turn, fade
