"""Arrays in, arrays out, compiled. No files, logs, parameter objects, clocks or global randomness.

Letters in shapes: P points, N superpoints. `reference.py` holds slow, obvious twins. Those of the
paper's method are in `paper/kernels`.
"""
