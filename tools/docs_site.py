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
}

#: The page about the reference, and a link to the program of a notebook.
_REFERENCE = "reference/index.md"
_NOTEBOOK = re.compile(rf"(\]\((?:[./]*notebooks/)?(?:{'|'.join(NAMES)}))\.py\)")

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
        files.append(File.generated(config, path, content=_from_root((ROOT / source).read_text("utf-8"))))
    return files


def _from_root(content: str) -> str:
    """A page of the repository's root as it reads from inside docs/."""
    return content.replace("](docs/", "](")


def on_page_markdown(markdown: str, page: Any, config: Any, files: Any) -> str:
    """Let links to files of the repository lead to what the site has of them: the copies, the pages of the
    notebooks and, from the page about the reference, its generated pages.
    """
    up = "../" * page.file.src_uri.count("/")
    for path, source in COPIES.items():
        markdown = re.sub(rf"\]\((?:\.\./)+{re.escape(source)}(?=[#)])", f"]({up}{path}", markdown)
    if page.file.src_uri == _REFERENCE:
        links = (f"- [{_title(text)}]({path.removeprefix('reference/')})" for path, text in _made().items())
        markdown += "\n" + "\n".join(links) + "\n"
    return _NOTEBOOK.sub(r"\1.md)", markdown)


def _made() -> dict[str, str]:
    return {path: text for path, text in pages().items() if path.startswith("reference/")}


def _title(text: str) -> str:
    """What stands in the heading of a page."""
    return text.partition("\n")[0].lstrip("# ")


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
