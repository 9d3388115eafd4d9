"""Which results there are, what each is made of, and which can be made of the logs at hand."""
