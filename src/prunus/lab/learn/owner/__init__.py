"""Learning the network that tells whose wood is."""
