"""The filters, one a file, and the table by which they are chosen."""

from collections.abc import Mapping
from types import MappingProxyType

from guidance_app.estimation.filter import Filter, FilterFactory, FilterSettings
from guidance_app.estimation.filters.adaptive import Adaptive
from guidance_app.estimation.filters.gyro_ekf import GyroFilter
from guidance_app.estimation.filters.off import Off
from guidance_app.estimation.filters.quantisation_kf import QuantisationFilter

__all__ = ["FILTERS", "make_filter"]

FILTERS: Mapping[str, FilterFactory] = MappingProxyType(
    {
        "adaptive": Adaptive,
        "gyro_ekf": GyroFilter,
        "off": Off,
        "quantisation_kf": QuantisationFilter,
    }
)


def make_filter(name: str, settings: FilterSettings | None = None) -> Filter:
    """The filter of this name, ready for its first measurement. Raises ``ValueError`` that names the known ones."""
    try:
        factory = FILTERS[name]
    except KeyError:
        msg = f"there is no filter called {name!r}; there are {', '.join(FILTERS)}"
        raise ValueError(msg) from None
    return factory(settings or FilterSettings())
