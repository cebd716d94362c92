"""The point field: what a network says of every voxel of a cloud.

Voxels, a sparse U-Net over them (semantic segmentation, medial-axis voting, radius and direction
regression), and its votes: smart-tree, VoteNet and TreeLearn are the relatives.
"""
