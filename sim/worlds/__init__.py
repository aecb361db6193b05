"""The shipped worlds."""
