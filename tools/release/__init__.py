"""A release: `make cut` and `make release`, as CONTRIBUTING.md describes."""
