"""A campaign's folder: plan, identity and rows, each written whole or not at all and read back only as it was
written.
"""
