"""From a measurement to a pose: filters, reference point, prediction, initialisation, smoothing. No I/O, no clock."""
