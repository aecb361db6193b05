"""The trees of the complex jobs, as XML: what motion runs for 42 to 45, and what missions may take apart and change."""
