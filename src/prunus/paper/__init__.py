"""The paper's method, whole: superpoints, scored edges, tips, the search, side branches.

Section and equation of each part: docs/method.md. Its kernels take a compiler, which nothing of the
default does.
"""
