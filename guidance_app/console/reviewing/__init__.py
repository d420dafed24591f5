"""Looking back at the screen: the list of recordings, one of them on the map with its charts, and the ledger."""
