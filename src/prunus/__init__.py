"""From a 3D point cloud of a dormant fruit tree to a labelled skeleton.

    import prunus
    result = prunus.skeletonize(prunus.read_cloud("tree.ply"))
    result.skeleton.to_networkx()

Names are loaded when they are first used, so that `import prunus` is quick.
"""

import lazy_loader

__version__ = "0.2.0"
__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
