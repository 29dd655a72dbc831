"""Known events, how far they ran for their volume and fall, and how far one more may."""
