"""How good a skeleton is, against the truth."""
