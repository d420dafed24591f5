"""The account at a caster of corrections. It is no ``Document``: it holds a password, so it never travels with others.

It is kept for the whole data folder, in a file of its own (``store.caster``). No job, recording, backup or report holds
any of it, and neither its text form nor an error shows the password.
"""

from typing import Any

from pydantic import BaseModel, ConfigDict, Field, field_validator
from pydantic_core import PydanticCustomError

from guidance_app.language import message

__all__ = ["CasterAccount"]

HIDDEN: dict[str, Any] = {"secret": True}


class CasterAccount(BaseModel):
    """Where corrections for the receiver come from, and as whom they are asked for."""

    model_config = ConfigDict(frozen=True, extra="forbid", hide_input_in_errors=True, str_strip_whitespace=True)

    on: bool = Field(default=True, title="Use corrections")
    host: str = Field(
        "", title="Caster", max_length=253, description="Its name in the network, as in caster.example.org"
    )
    port: int = Field(2101, title="Port of the caster", ge=1, le=65535)
    mount: str = Field("", title="Mount point", max_length=100, description="The stream, as its operator names it")
    user: str = Field("", title="User", max_length=100)
    password: str = Field(
        "",
        title="Password",
        max_length=200,
        repr=False,
        description="Left empty, the one that is kept stays for the same caster and user",
        json_schema_extra=HIDDEN,
    )

    @field_validator("host")
    @classmethod
    def _is_a_host(cls, host: str) -> str:
        if not host or not host.isprintable() or any(one in " /@?#[]" for one in host):
            raise PydanticCustomError(
                "host", message("Write the caster's name alone, as in caster.example.org, or its number.")
            )
        return host

    @field_validator("mount")
    @classmethod
    def _is_a_mount_point(cls, mount: str) -> str:
        mount = mount.strip("/")
        if not mount or not mount.isprintable() or "/" in mount:
            raise PydanticCustomError(
                "mount", message("Write the mount point's name, as the caster's operator gave it.")
            )
        return mount

    @field_validator("user")
    @classmethod
    def _is_a_user(cls, user: str) -> str:
        if ":" in user or not user.isprintable():
            raise PydanticCustomError("user", message("A caster's user has no colon in the name."))
        return user
