"""What a campaign flies: its cases, what is dispersed, and how the numbers are drawn."""
