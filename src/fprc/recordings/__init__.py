"""Recordings of other people: reading, import, and whether a sealed chamber helps."""
