"""Learning the network of the point field."""
