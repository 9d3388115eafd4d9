"""The stages of the studies: one function for each rule, from files to files."""
