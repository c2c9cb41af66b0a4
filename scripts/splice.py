"""Tables that scripts put into documents, between `<!-- begin: NAME -->` and `<!-- end: NAME -->`."""

from pathlib import Path


def splice(document: Path, name: str, text: str) -> None:
    """Puts text in the place of what stands between the markers of a name."""
    before, rest = document.read_text().split(f"<!-- begin: {name} -->\n", 1)
    _, after = rest.split(f"<!-- end: {name} -->", 1)
    document.write_text(f"{before}<!-- begin: {name} -->\n\n{text}\n<!-- end: {name} -->{after}")
