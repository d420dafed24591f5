"""Measurements as ratios within one run: against a peer, or against the same code at another size."""
