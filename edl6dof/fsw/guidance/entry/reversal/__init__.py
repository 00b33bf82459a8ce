"""Bank-reversal logics: the side to which the vehicle banks, shared by every entry law."""
