"""Powered landings designed on the ground."""
