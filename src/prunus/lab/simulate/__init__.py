"""The wide orchard: trees, surroundings and scanners drawn from ranges far wider than ours.

`wide.toml` documents every range. The trees and rigs of `prunus.simulate` are one corner of it.
"""
