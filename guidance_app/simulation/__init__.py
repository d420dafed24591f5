"""A tractor, its driver and its receiver, as a peer of a real one: what comes out are the bytes of a receiver."""
