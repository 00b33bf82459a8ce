"""The hazard detectors: one file each."""
