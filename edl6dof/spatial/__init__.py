"""Vectors, quaternions, frames and interpolation: the compiled algebra of all other modules."""
