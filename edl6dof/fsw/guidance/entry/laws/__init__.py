"""One file for each entry guidance law."""
