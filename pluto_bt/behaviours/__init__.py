"""The leaves of the library: start something, watch its status, say why it failed. `catalogue` lists them."""
