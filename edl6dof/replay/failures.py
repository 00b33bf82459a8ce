"""Failures of the viewer and of the encoder of films, apart from both: a command that may meet them need not
import the viewer.
"""


class ViewerFailed(RuntimeError):
    """The viewer ended before its work was done, or does not do its work."""


class NoViewer(ViewerFailed):
    """This machine lacks what the viewer needs; the text says what."""


class NoFilm(RuntimeError):
    """A library, graphics or the encoder is missing, or the encoder failed; the text says which."""
