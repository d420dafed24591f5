"""The caster that a drive takes its corrections from: that of the data folder's account, where there is one in use."""

from pathlib import Path

from guidance_app.documents.caster import CasterAccount
from guidance_app.sources import takes_corrections
from guidance_app.sources.ntrip import Caster
from guidance_app.store.caster import caster_account

__all__ = ["caster_for", "caster_of"]


def caster_for(data: Path, uri: str) -> Caster | None:
    """None without an account, with one that is switched off, and for a receiver that takes no corrections.

    Raises ``StoreError`` for an account that cannot be read.
    """
    account = caster_account(data) if takes_corrections(uri) else None
    return None if account is None or not account.on else caster_of(account)


def caster_of(account: CasterAccount) -> Caster:
    """Where this account leads to."""
    return Caster(account.host, account.port, account.mount, account.user, account.password)
