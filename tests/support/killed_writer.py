"""A program for the power-cut test: writers are killed while they write, and what they said was stored is sought.

Usage: python killed_writer.py FOLDER KILLS SEED. A child process stores documents and says so after each one through a
pipe; it is killed with SIGKILL after a random time; then a fresh store must hold everything that was said. Prints one
JSON object: how many kills, how many of them struck before the child was done with what it had begun, and the losses.
"""

import json
import os
import random
import select
import signal
import sys
import time
from pathlib import Path
from typing import NoReturn

from guidance_app.documents import FieldDocument, Implement, Operation, Tractor
from guidance_app.store import Store
from support.documents import field_named, operation_named, tractor_named

PADDING = "0123456789" * 350
"""Makes the field's document some kilobytes long, so that a write takes time."""
TRACTORS = 5
FIELD = field_named("Field", "0 begin")


def write_on(root: Path, begin: int, pipe: int) -> NoReturn:
    """Stores one document after the other, each with the next number, and says each number once it is stored."""
    store = Store(root)
    for number in range(begin, begin + 10_000):
        store_one(store, number)
        os.write(pipe, number.to_bytes(4, "big"))
    os._exit(0)


def store_one(store: Store, number: int) -> None:
    """A changed field, a changed tractor, a renamed implement and a new operation, in turn."""
    match number % 4:
        case 0:
            store.replace(FIELD.model_copy(update={"notes": f"{number} {PADDING}"}))
        case 1:
            store.replace(tractor_named(f"T{number // 4 % TRACTORS}", 1 + number % 4096 / 1000))
        case 2:
            old = max((each.document.name for each in store.list(Implement)), key=lambda name: int(name[1:]))
            store.rename(Implement, old, f"I{number}")
        case _:
            store.replace(operation_named(f"O{number // 4 % 7}", "Field").model_copy(update={"product": str(number)}))


def stored_number(store: Store, number: int) -> bool:
    """Whether what was stored under this number, or something later in its place, is there."""
    match number % 4:
        case 0:
            return int(store.load(FieldDocument, "Field").document.notes.split()[0]) >= number
        case 1:
            name = f"T{number // 4 % TRACTORS}"
            return any(each.document.name == name for each in store.list(Tractor))
        case 2:
            names = [each.document.name for each in store.list(Implement)]
            return any(int(name[1:]) >= number for name in names)
        case _:
            operation = store.load(Operation, f"O{number // 4 % 7}", "Field").document
            return int(operation.product) >= number


def killed_once(root: Path, begin: int, delay: float) -> list[int]:
    """Starts a writer, kills it ``delay`` seconds after its first word, and gives the numbers that it said."""
    reading, writing = os.pipe()
    child = os.fork()
    if child == 0:
        os.close(reading)
        write_on(root, begin, writing)
    os.close(writing)
    heard = os.read(reading, 4)
    deadline = time.monotonic() + delay
    while (left := deadline - time.monotonic()) > 0 and select.select([reading], [], [], left)[0]:
        heard += os.read(reading, 4096)
    os.kill(child, signal.SIGKILL)
    os.waitpid(child, 0)
    while more := os.read(reading, 4096):
        heard += more
    os.close(reading)
    return [int.from_bytes(heard[place : place + 4], "big") for place in range(0, len(heard), 4)]


def main(folder: str, kills: str, seed: str) -> None:
    root, dice = Path(folder), random.Random(int(seed))
    store = Store(root)
    store.save(FIELD)
    store.save(Implement(name="I0"))
    begin, said_in_all, lost, unfinished = 0, 0, [], 0
    for _ in range(int(kills)):
        said = killed_once(root, begin, dice.random() * 0.004)
        fresh = Store(root)
        lost += [number for number in said[-8:] if not stored_number(fresh, number)]
        lost += [problem.sentence for problem in fresh.problems]
        for left_over in root.rglob(".*.tmp"):
            left_over.unlink()
            unfinished += 1
        said_in_all += len(said)
        begin = said[-1] + 5  # what it had begun may be stored or not: leave that number alone
    json.dump({"kills": int(kills), "said": said_in_all, "unfinished": unfinished, "lost": lost}, sys.stdout)


if __name__ == "__main__":
    main(*sys.argv[1:])
