"""Design of a campaign: its cases, what is dispersed, and how the numbers are drawn."""
