"""The laboratory: what makes and judges the chain."""
