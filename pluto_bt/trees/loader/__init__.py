"""From mission files to a mission: read all files, check every tree as written, expand the main tree, build the nodes."""
