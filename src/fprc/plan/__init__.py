"""The results, what each is made of, and which of them can be made from the existing logs."""
