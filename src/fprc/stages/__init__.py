"""One function per rule of the workflow: read files, call lower layers, write files."""
