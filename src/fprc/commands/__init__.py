"""What the verbs of the `fprc` command do; one module each."""
