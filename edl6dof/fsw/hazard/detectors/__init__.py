"""The ways to tell safe ground: one file each."""
