"""The commands of `pluto`, one file each; every file has `main(argv) -> exit code`."""
