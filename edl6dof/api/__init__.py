"""What ``import edl6dof`` offers, and the command line shows: flights, campaigns and all that is made of
them, as objects.
"""
