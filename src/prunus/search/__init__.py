"""The population-based search for the best skeleton: score -> eligible -> potential -> resample."""

from prunus.search.population import search
from prunus.search.result import SearchResult
from prunus.search.score import skel_score

__all__ = ["SearchResult", "search", "skel_score"]
