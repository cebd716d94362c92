"""Traits of branches and trees, as phenotyping knows them."""
