"""The Python API: flights, campaigns and all that is made of them, as objects."""
