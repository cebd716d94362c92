"""Skeletons as meshes."""
