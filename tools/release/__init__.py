"""A release: `make release`, as CONTRIBUTING.md describes."""
