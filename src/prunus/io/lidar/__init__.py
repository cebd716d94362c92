"""LAS, LAZ and E57, with what they say of their frame."""
