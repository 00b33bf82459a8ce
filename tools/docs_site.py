"""Hooks of the documentation site (mkdocs.yml): pages made from the program, files from outside docs/,
formulas.

Formulas are written in LaTeX between dollars and become MathML, which browsers draw by themselves: a page
that is read fetches nothing.
"""

from __future__ import annotations

import html
import re
from pathlib import Path
from typing import Any

from docs_notebooks import NAMES, notebook
from docs_reference import pages

ROOT = Path(__file__).resolve().parents[1]

#: Files of the repository that the site shows too: its page or file, and where it lies.
COPIES = {
    "contributing.md": "CONTRIBUTING.md",
    "changelog.md": "CHANGELOG.md",
    "assets/modulation.png": ".assets/modulation.png",
}

#: First and last letter of alphabets, and where their bold ones begin.
_ALPHABETS = (("A", "Z", 0x1D400), ("a", "z", 0x1D41A), ("\u03b1", "\u03c9", 0x1D6C2))
_BOLD = re.compile(r'<m[in] mathvariant="bold[a-z-]*">(&#x[0-9A-F]+;|.)</m[in]>')
_FORMULA = re.compile(r'<(span|div) class="arithmatex">(.*?)</\1>', re.DOTALL)


def on_files(files: Any, config: Any) -> Any:
    """Add the generated pages and the copies."""
    from mkdocs.structure.files import File

    for path, text in pages().items():
        files.append(File.generated(config, path, content=text))
    for name in NAMES:
        files.append(File.generated(config, f"notebooks/{name}.ipynb", content=notebook(name)))
    for path, source in COPIES.items():
        content = (ROOT / source).read_bytes()
        files.append(
            File.generated(config, path, content=_from_root(content) if path.endswith(".md") else content)
        )
    return files


def _from_root(content: bytes) -> str:
    """A page of the repository's root as it reads from inside docs/."""
    return content.decode().replace("](docs/", "](")


def on_page_markdown(markdown: str, page: Any, config: Any, files: Any) -> str:
    """Turn links that lead out of docs/ into links to the copies."""
    for path, source in COPIES.items():
        markdown = markdown.replace(f"](../{source})", f"]({path})")
    return markdown


def on_page_content(content: str, page: Any, config: Any, files: Any) -> str:
    """Draw the formulas."""
    return _FORMULA.sub(_mathml, content)


def _mathml(found: re.Match[str]) -> str:
    from latex2mathml.converter import convert

    text = html.unescape(found[2]).strip()
    display = "block" if text.startswith("\\[") else "inline"
    return _BOLD.sub(_bold, convert(text[2:-2].strip(), display=display))


def _bold(found: re.Match[str]) -> str:
    """A bold letter as the character it is: browsers no longer know ``mathvariant``."""
    letter = html.unescape(found[1])
    for first, last, place in _ALPHABETS:
        if first <= letter <= last:
            letter = chr(place + ord(letter) - ord(first))
            break
    return f"<mi>{letter}</mi>"
