"""One function per rule of the workflow: read files, call below, write files."""
