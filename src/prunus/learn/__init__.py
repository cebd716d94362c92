"""Learn the edge confidence from simulated scans: labels, networks, training. Needs torch."""
