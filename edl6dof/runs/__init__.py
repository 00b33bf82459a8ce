"""The folder of one flight: written whole or not at all, read back without loading code."""
