"""What is designed on the ground before a flight."""
