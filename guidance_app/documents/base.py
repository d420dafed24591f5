"""What all documents share: names, and numbers and choices from which a form can be made."""

from collections.abc import Mapping
from typing import Annotated, Any, Literal

from pydantic import AfterValidator, BaseModel, ConfigDict, Field

from guidance_app.language import sentence

__all__ = ["Document", "Name", "choice", "quantity"]


def quantity(  # noqa: PLR0913 - a form needs all of these, and a call names each
    title: str,
    unit: str,
    low: float,
    high: float,
    default: Any = ...,
    *,
    help: str = "",  # noqa: A002 - the form's own word for it
    step: float = 0.01,
    picture: str | None = None,
    when: tuple[str, Any] | None = None,
) -> Any:
    """A number field with a title, a unit and inclusive bounds; the form and the checks both come from it."""
    extra: dict[str, Any] = {"unit": unit, "step": step}
    if picture is not None:
        extra["picture"] = picture
    if when is not None:
        extra["when"] = when
    return Field(
        default,
        title=title,
        description=help,
        ge=low,
        le=high,
        allow_inf_nan=False,
        json_schema_extra=extra,
    )


def choice(
    title: str,
    default: Any,
    labels: Mapping[str, str],
    *,
    help: str = "",  # noqa: A002 - the form's own word for it
    when: tuple[str, Any] | None = None,
) -> Any:
    """A field whose values are those of ``labels``, which hold what a person reads for each.

    ``when`` names another member, and the value or the list of values for which this one matters.
    """
    extra: dict[str, Any] = {"labels": dict(labels)}
    if when is not None:
        extra["when"] = when
    return Field(default, title=title, description=help, json_schema_extra=extra)


def _clean_name(name: str) -> str:
    cleaned = " ".join(name.split())
    if not cleaned:
        raise ValueError(sentence("A name needs at least one character."))
    if any(ord(character) < 32 or ord(character) == 127 for character in cleaned):
        raise ValueError(sentence("A name cannot hold control characters."))
    return cleaned


Name = Annotated[str, Field(title="Name", max_length=120), AfterValidator(_clean_name)]


class Document(BaseModel):
    """What every saved document shares. Unknown members are refused: a typing error must not pass silently."""

    model_config = ConfigDict(frozen=True, extra="forbid", validate_default=True)

    schema_version: Literal[1] = 1
