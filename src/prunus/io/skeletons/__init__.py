"""Skeletons to files and from files, ours and those of other tools."""
