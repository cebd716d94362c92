"""One self-contained HTML page a tree."""

from prunus.report.page import report_page

__all__ = ["report_page"]
