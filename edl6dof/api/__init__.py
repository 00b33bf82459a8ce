"""Python API: flights, campaigns and their results as objects."""
