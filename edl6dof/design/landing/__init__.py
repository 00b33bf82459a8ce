"""Powered landings designed on the ground: the convex problem, and its solution by an interior-point method."""
