"""Ways to a field: typed, tapped, driven or from a file. Each ends in the same preview, and only that stores."""
