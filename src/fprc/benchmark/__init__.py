"""Speed compared with other libraries, and cost of larger problems."""
