"""Formats of other programs: DAVE-ML vehicle models in, NASA check-case tables out."""
