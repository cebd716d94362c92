"""Growth: from threads to trees, each from its own foot.

Nodes on the axes of branches are joined to a graph, ways are found from the feet over it, ways are
cut into branches, and branches are labelled under the grammar.
"""
