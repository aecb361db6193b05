"""What a run is made of, read from files and options and checked: mission, world, map, platform, values. All faults of all files at once."""
