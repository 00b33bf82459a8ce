"""What the documents name is there."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
DOCUMENTS = (
    *("README.md", "CONTRIBUTING.md", "docs/robustness.md", "tools/README.md"),
    *sorted(str(page.relative_to(ROOT)) for page in (ROOT / "docs" / "theory").glob("*.md")),
)


@pytest.mark.parametrize("name", DOCUMENTS)
def test_files_that_a_document_names_exist(name):
    text = (ROOT / name).read_text(encoding="utf-8")
    named = set(re.findall(r"\b(?:tests|tools|docs|scenarios|edl6dof)/[\w./-]*\w", text))
    missing = [
        path for path in sorted(named) if not (ROOT / path).exists() and not (ROOT / f"{path}.yaml").exists()
    ]
    assert named and not missing
