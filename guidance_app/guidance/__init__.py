"""Guidance: what to drive. Plans of a whole field, families of lines, tracking of the pass, and worked area."""
