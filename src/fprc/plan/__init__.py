"""The results, what they are made of, and which of them can be made from the existing logs."""
