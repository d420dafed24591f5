"""Logs without a screen: what a receiver's log says of itself, and a log through the whole engine as a table."""
