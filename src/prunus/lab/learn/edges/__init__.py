"""Learning the network of the paper's method: which candidate edges are real."""
