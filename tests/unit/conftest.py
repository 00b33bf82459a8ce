"""Tests below find ``as_flown`` and ``forked`` in this folder."""
