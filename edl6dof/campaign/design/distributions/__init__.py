"""What a dispersed parameter may be: one file for each distribution, one line for each in the registry."""
