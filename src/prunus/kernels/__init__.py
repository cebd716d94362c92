"""Arrays in, arrays out, compiled. No files, logs, parameter objects, clocks or global randomness.

Letters in shapes: P points, N superpoints, E candidate edges, D = 2 E directed edges, T tips,
K candidates, W 64-bit words of a node set. `reference.py` holds a slow, obvious twin of each.
"""
