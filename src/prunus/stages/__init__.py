"""One file per box of the paper's pipeline: model in, model out."""
