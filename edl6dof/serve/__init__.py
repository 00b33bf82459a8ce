"""Flights stepped over a local socket: flight software in any language flies the plant (docs/serve.md)."""
