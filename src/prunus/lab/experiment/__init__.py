"""The paper's result section in one command: simulated trees, corrections, tables, figures."""
