"""Configuration: YAML files to validated parameter models to records for compiled code."""
