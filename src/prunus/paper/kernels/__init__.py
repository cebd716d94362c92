"""The compiled loops of the paper's method; slow twins in `tests/reference.py`.

Letters in shapes: N superpoints, E candidate edges, D = 2 E directed edges, T tips, K candidates,
W 64-bit words of a node set.
"""
