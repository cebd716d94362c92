"""The population-based search: score -> eligible -> potential -> resample, K candidates at once."""

from prunus.search.population import SearchResult, search
from prunus.search.score import skel_score

__all__ = ["SearchResult", "search", "skel_score"]
