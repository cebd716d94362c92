"""Measurements: the only place from which performance is claimed."""
