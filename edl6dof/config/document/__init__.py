"""YAML documents as plain data with places: found, read, extended, overridden, written."""
