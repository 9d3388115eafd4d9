"""A model that learns while it runs, on families of rigs with a disturbed P_o."""
