"""The navigation filters, one in each file."""
