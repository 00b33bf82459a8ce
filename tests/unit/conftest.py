"""Tests below find ``as_flown`` and ``small_programs`` in this folder."""
