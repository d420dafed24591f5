"""What a bench cannot do, as a sentence."""

__all__ = ["BenchError"]


class BenchError(Exception):
    """What is missing for a measurement and what to do about it, in one sentence for the person at the terminal."""
