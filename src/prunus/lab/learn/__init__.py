"""How the learned parts of the chain are learned."""
