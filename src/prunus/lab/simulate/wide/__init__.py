"""The wide orchard: trees of many kinds, seen by many scanners, in many surroundings.

`wide.toml` documents every range. The trees and rigs of `prunus.lab.simulate` are one corner of it.
"""
