"""Subcommands of `fprc`, one module each."""
