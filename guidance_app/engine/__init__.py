"""Event in, next snapshot out: the order of the steps from bytes to guidance, and nothing else."""

from guidance_app.engine.engine import Engine

__all__ = ["Engine"]
