"""Drag profiles that laws follow, and the corridor they lie in."""
