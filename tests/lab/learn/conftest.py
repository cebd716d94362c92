"""Small networks on one thread: several, on cores that others use, wait for each other."""

import torch

torch.set_num_threads(1)
