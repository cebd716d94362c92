"""Tables as HTML."""


def html_table(names: list[str], rows: list[list[str]]) -> str:
    """A table as HTML; the cells may hold markup."""
    head = "".join(f"<th>{name}</th>" for name in names)
    body = "".join("<tr>" + "".join(f"<td>{cell}</td>" for cell in row) + "</tr>" for row in rows)
    return f"<table><tr>{head}</tr>{body}</table>"
