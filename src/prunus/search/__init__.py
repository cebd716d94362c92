"""The search for the best skeleton.

As in the paper: score -> eligible -> potential -> resample, K candidates at once (population).
Beyond it: a score learned from simulated trees, climbed from the cheapest tree (learned).
"""

from prunus.search.learned import (
    goes_by_learned_score,
    learned_score_of,
    search_learned,
    shipped_score,
)
from prunus.search.population import search
from prunus.search.result import SearchResult
from prunus.search.score import skel_score

__all__ = [
    "SearchResult",
    "goes_by_learned_score",
    "learned_score_of",
    "search",
    "search_learned",
    "shipped_score",
    "skel_score",
]
