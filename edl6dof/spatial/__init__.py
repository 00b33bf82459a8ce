"""Vectors, quaternions, frames and interpolation: the compiled algebra everything else is written in."""
