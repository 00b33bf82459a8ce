"""The replay in a browser: one HTML file that holds a recording and the viewer and plays offline from
``file://``, and a server of that page for this machine.

The viewer's program (wasm) comes from the installed rerun, so that it always fits the recording.  rerun does
not promise to keep its interface; the version is pinned, and a test opens the page in a browser.

The server only answers requests that name this machine as their host: a web site whose own name resolves to
127.0.0.1 (DNS rebinding) gets nothing, and no other site may read or frame the page.
"""

from __future__ import annotations

import base64
import gzip
import os
import socketserver
import subprocess
import sys
import urllib.request
from contextlib import suppress
from functools import cache
from http import HTTPStatus
from http.server import BaseHTTPRequestHandler
from pathlib import Path
from typing import Any

from jinja2 import StrictUndefined, Template
from markupsafe import Markup

from edl6dof.child import python
from edl6dof.replay.viewer import HOST, free_port, running

_HEADERS = {
    "Content-Type": "text/html; charset=utf-8",
    "Cache-Control": "no-store",
    "Cross-Origin-Resource-Policy": "same-origin",
    "X-Content-Type-Options": "nosniff",
    "X-Frame-Options": "DENY",
}


def page(recording: Path, title: str) -> bytes:
    """Return the HTML file of a recording.

    Raises:
        ViewerFailed: the installed rerun does not provide the viewer's program.
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
    """The viewer for browsers (script, packed wasm), from rerun's own server on this machine."""
    port, data = free_port(), free_port()
    with running("--serve-web", "--web-viewer-port", str(port), "--port", str(data)) as program:
        program.wait_for(port)
        open_url = urllib.request.build_opener(urllib.request.ProxyHandler({})).open
        found = []
        for name in ("re_viewer.js", "re_viewer_bg.wasm"):
            with open_url(f"http://{HOST}:{port}/{name}", timeout=30.0) as answer:
                found.append(bytes(answer.read()))
    return found[0].decode("utf-8"), _packed(found[1])


def _packed(content: bytes) -> str:
    """Compress and encode as text; level 6 would take two thirds longer for 1 % less."""
    return base64.b64encode(gzip.compress(content, 5, mtime=0)).decode("ascii")


class PageServer(socketserver.ThreadingTCPServer):
    """Serves one page on a free port of this machine, under its ``hosts``."""

    daemon_threads = True

    def __init__(self, page: bytes) -> None:
        super().__init__((HOST, 0), _Request)
        self.page = page
        port = self.server_address[1]
        self.url = f"http://{HOST}:{port}/"
        self.hosts = {f"{host}:{port}" for host in (HOST, "localhost", "[::1]")}

    def handle_error(self, request: Any, client_address: Any) -> None:
        """Ignore a browser that closes its connection."""
        if not isinstance(sys.exception(), ConnectionError):
            super().handle_error(request, client_address)


class _Request(BaseHTTPRequestHandler):
    """Answers GET and HEAD of ``/``; 403 to a request for another host, 404 to one for another path."""

    server: PageServer
    timeout = 30.0

    def do_GET(self) -> None:
        """Send the headers, and for GET the page."""
        hosts = self.headers.get_all("Host", [])
        if len(hosts) != 1 or hosts[0].lower() not in self.server.hosts:
            self.send_error(HTTPStatus.FORBIDDEN)
        elif self.path != "/":
            self.send_error(HTTPStatus.NOT_FOUND)
        else:
            self.send_response(HTTPStatus.OK)
            for name, value in {**_HEADERS, "Content-Length": str(len(self.server.page))}.items():
                self.send_header(name, value)
            self.end_headers()
            if self.command == "GET":
                self.wfile.write(self.server.page)

    do_HEAD = do_GET

    def log_message(self, *_: Any) -> None:
        """Write no log."""


def serve(page: bytes) -> None:
    """Serve the page, print its address, open a browser if there is one, and run until Ctrl-C."""
    with PageServer(page) as server:
        print(f"{server.url}\nCtrl-C stops it; nobody but this machine can open it", flush=True)
        _open(server.url)
        with suppress(KeyboardInterrupt):
            server.serve_forever()


def _open(url: str) -> None:
    """Open a browser if there is a display; it prints nothing here, and Ctrl-C does not end it."""
    if sys.platform == "linux" and not (os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY")):
        return  # Python would start a browser for terminals
    silent = subprocess.DEVNULL
    words = python("import webbrowser; webbrowser.open(sys.argv[1])", url)
    subprocess.Popen(words, stdin=silent, stdout=silent, stderr=silent, start_new_session=True)
