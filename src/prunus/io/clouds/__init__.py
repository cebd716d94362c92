"""Point clouds from files and to files."""
