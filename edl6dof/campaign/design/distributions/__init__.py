"""Distributions of a dispersed parameter: one file for each, one line for each in the registry."""
