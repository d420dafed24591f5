"""The guidance console: an ordinary receiver and any tablet's browser guide a tractor along its passes.

The package is laid out so that one fix can be walked from the wire to the pixel: ``sources``, ``runtime``,
``engine``, ``decode``, ``geodesy``, ``estimation``, ``guidance``, ``view``, ``console``. A module imports only what
stands below it in that order; ``pyproject.toml`` holds the contracts that say so.
"""

__version__ = "0.1.0"
