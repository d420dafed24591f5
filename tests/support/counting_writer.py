"""A program for the two-consoles test: counts up in one document, again whenever the other console was faster.

Usage: python counting_writer.py FOLDER TIMES NAME. Says that it is ready, begins at a line of input, and counts so many
times and on until the other was faster once, MOST times at most. Prints how often it counted and had to do it again.
"""

import sys
from pathlib import Path

from guidance_app.documents import FieldDocument
from guidance_app.store import Store, StoreConflictError

MOST = 5000


def count_up(store: Store, name: str) -> int:
    """One more in the field's notes, with the counter's name; gives the number of conflicts on the way."""
    conflicts = 0
    while True:
        stored = store.load(FieldDocument, "Counter")
        count = int(stored.document.notes.split()[0]) + 1
        counted = stored.document.model_copy(update={"notes": f"{count} {name}"})
        try:
            store.save(counted, stored.revision)
        except StoreConflictError:
            conflicts += 1
        else:
            return conflicts


if __name__ == "__main__":
    own = Store(Path(sys.argv[1]))
    sys.stdout.write("ready\n")
    sys.stdout.flush()
    sys.stdin.readline()
    steps = conflicts_met = 0
    while steps < int(sys.argv[2]) or (conflicts_met == 0 and steps < MOST):
        conflicts_met += count_up(own, sys.argv[3])
        steps += 1
    sys.stdout.write(f"{steps} {conflicts_met}\n")
