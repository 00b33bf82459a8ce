"""Designs made on the ground before a flight."""
