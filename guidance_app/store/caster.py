"""The account at a caster of corrections, in a file of the data folder that its owner alone can read.

The file's name begins with a dot, so no backup takes it along, and a restore leaves it where it is.
"""

from pathlib import Path

from pydantic import ValidationError

from guidance_app.documents.caster import CasterAccount
from guidance_app.language import sentence
from guidance_app.store.files import FolderLock, StoreError, read_bounded, why, write_atomically

__all__ = ["caster_account", "forget_caster_account", "keep_caster_account"]

ACCOUNT = ".caster.json"
OWNER_ONLY = 0o600


def caster_account(root: Path) -> CasterAccount | None:
    """The account of this data folder; None without one. Raises ``StoreError``, which does not repeat what it holds."""
    path = root / ACCOUNT
    try:
        return CasterAccount.model_validate_json(read_bounded(path))
    except FileNotFoundError:
        return None
    except OSError as error:
        msg = sentence("The caster's account in {path} cannot be read: {reason}.", path=path, reason=why(error))
    except ValidationError:
        msg = sentence("The caster's account in {path} is damaged: enter it again.", path=path)
    raise StoreError(msg) from None


def keep_caster_account(root: Path, account: CasterAccount) -> None:
    """Keeps it in the place of the one before. Raises ``StoreError``."""
    with FolderLock(root).writing():
        write_atomically(root / ACCOUNT, account.model_dump_json(indent=1).encode() + b"\n", OWNER_ONLY)


def forget_caster_account(root: Path) -> None:
    """Takes it away. Raises ``StoreError``."""
    try:
        (root / ACCOUNT).unlink(missing_ok=True)
    except OSError as error:
        msg = sentence("The caster's account in {path} stays: {reason}.", path=root / ACCOUNT, reason=why(error))
        raise StoreError(msg) from error
