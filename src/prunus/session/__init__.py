"""A tree being edited: its journal, its history, and the folder that keeps them."""

from prunus.session.journal import Status, status_of
from prunus.session.sources import Settings
from prunus.session.work import Work

__all__ = ["Settings", "Status", "Work", "status_of"]
