"""One HTML file that holds a recording and the viewer, and plays offline from ``file://``.

The viewer's program (wasm) comes from the installed rerun itself, so that it always fits the recording.  It
is started by an interface that rerun does not promise to keep; the version is pinned, and a test opens the
page in a browser.
"""

from __future__ import annotations

import base64
import gzip
import urllib.request
from functools import cache
from pathlib import Path

from jinja2 import StrictUndefined, Template
from markupsafe import Markup

from edl6dof.replay.program import HOST, free_port, running


def page(recording: Path, title: str) -> bytes:
    """The HTML file of a recording.

    Raises:
        ViewerFailed: the viewer's program cannot be had from the installed rerun.
    """
    script, wasm = _program()
    template = Template(
        Path(__file__).with_suffix(".html").read_text(encoding="utf-8"),
        autoescape=True,
        undefined=StrictUndefined,
        keep_trailing_newline=True,
    )
    return template.render(
        title=title,
        program=Markup(script.replace("</script", "<\\/script")),
        wasm=wasm,
        recording=_packed(recording.read_bytes()),
    ).encode("utf-8")


@cache
def _program() -> tuple[str, str]:
    """The viewer for browsers: its script and its packed wasm, asked from rerun's own server on this machine,
    which serves nothing else; the same for every page.
    """
    port, data = free_port(), free_port()
    with running("--serve-web", "--web-viewer-port", str(port), "--port", str(data)) as program:
        program.wait_for(port)
        script, wasm = (
            _fetch(f"http://{HOST}:{port}/{name}") for name in ("re_viewer.js", "re_viewer_bg.wasm")
        )
    return script.decode("utf-8"), _packed(wasm)


def _fetch(url: str) -> bytes:
    with urllib.request.build_opener(urllib.request.ProxyHandler({})).open(url, timeout=30.0) as answer:
        return bytes(answer.read())


def _packed(content: bytes) -> str:
    """Compressed, as text; level 6 would take two thirds longer for a hundredth less."""
    return base64.b64encode(gzip.compress(content, 5, mtime=0)).decode("ascii")
